// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/pad_id.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>

namespace imomushi {

namespace {

constexpr std::size_t kGuidDigits = 32, kKindDigits = 9;  // "045e:028e"
constexpr int kAny = 1, kSameName = 1, kSameKind = 2, kSameGuid = 3;

bool isDigit16(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

/// "GUID VVVV:PPPP NAME", taken apart; none: it is a name.
struct PadText {
    std::string_view guid, kind, name;
};
std::optional<PadText> padText(std::string_view text) {
    constexpr std::size_t begin = kGuidDigits + 1 + kKindDigits + 1;
    if (text.size() < begin || text[kGuidDigits] != ' ' || text[begin - 1] != ' ' || !std::all_of(text.begin(), text.begin() + kGuidDigits, isDigit16)) return std::nullopt;
    return PadText{text.substr(0, kGuidDigits), text.substr(kGuidDigits + 1, kKindDigits), text.substr(begin)};
}

}  // namespace

std::string PadId::text() const {
    std::array<char, kKindDigits + 1> kind{};
    (void)std::snprintf(kind.data(), kind.size(), "%04x:%04x", unsigned{vendor}, unsigned{product});
    return guid + " " + kind.data() + " " + name;
}

std::string_view PadId::nameIn(std::string_view text) {
    const auto known = padText(text);
    return known ? known->name : text;
}

int likeness(std::string_view wanted, const PadId& pad) {
    if (wanted.empty()) return kAny;
    const auto known = padText(wanted);
    if (!known) return wanted == pad.name ? kSameName : 0;
    if (known->guid == pad.guid) return kSameGuid;
    const std::string is = pad.text();
    // A pad without numbers of its maker is known by its name alone.
    return known->kind == padText(is)->kind && known->name == pad.name ? kSameKind : 0;
}

}  // namespace imomushi
