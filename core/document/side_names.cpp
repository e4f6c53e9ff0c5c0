// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/side_names.h"

#include <array>

namespace imomushi {

namespace {

using Text = std::string_view;

bool isLower(char c) { return c >= 'a' && c <= 'z'; }
bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool isLetter(char c) { return isLower(c) || isUpper(c); }
bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isSeparator(char c) { return c == '.' || c == '_' || c == '-' || c == ' '; }

char otherLetter(char c) { return c == 'L' ? 'R' : c == 'R' ? 'L' : c == 'l' ? 'r' : c == 'r' ? 'l' : '\0'; }

/// "arm.L", "arm_l 2", "arm.L.001", "L_arm".
std::optional<std::string> letterExchanged(Text name) {
    std::string out(name);
    if (name.size() > 2 && isSeparator(name[1]) && otherLetter(name[0])) {
        out[0] = otherLetter(name[0]);
        return out;
    }
    std::size_t end = name.size();
    while (end > 0 && isDigit(name[end - 1])) --end;
    if (end < name.size() && end > 0 && isSeparator(name[end - 1]))
        --end;
    else
        end = name.size();
    if (end > 2 && isSeparator(name[end - 2]) && otherLetter(name[end - 1])) {
        out[end - 1] = otherLetter(name[end - 1]);
        return out;
    }
    return std::nullopt;
}

/// A word that is not part of a longer one: "leftover" has none, "armLeft2" and "LeftArm" do.
bool isWord(Text name, std::size_t at, Text word) {
    const char before = at > 0 ? name[at - 1] : ' ', first = word.front();
    const char after = at + word.size() < name.size() ? name[at + word.size()] : ' ';
    const bool capital = isUpper(first) && isLower(word[1]);
    if (isLetter(first) && !capital && isLetter(before)) return false;
    return isUpper(first) && !capital ? !isLetter(after) : !isLower(after);
}

std::optional<std::string> wordExchanged(Text name) {
    static constexpr std::array<std::pair<Text, Text>, 4> kWords{{{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"左", "右"}}};
    for (const auto& [left, right] : kWords)
        for (const auto& [from, to] : {std::pair(left, right), std::pair(right, left)})
            for (std::size_t at = name.find(from); at != Text::npos; at = name.find(from, at + 1))
                if (isWord(name, at, from)) return std::string(name.substr(0, at)).append(to).append(name.substr(at + from.size()));
    return std::nullopt;
}

}  // namespace

std::string otherSide(Text name) {
    if (auto made = letterExchanged(name)) return *made;
    if (auto made = wordExchanged(name)) return *made;
    return std::string(name);
}

std::string otherSide(Text name, const std::pair<std::string, std::string>& suffixes) {
    for (const auto& [from, to] : {suffixes, std::pair(suffixes.second, suffixes.first)})
        if (name.ends_with(from)) return std::string(name.substr(0, name.size() - from.size())).append(to);
    return std::string(name);
}

}  // namespace imomushi
