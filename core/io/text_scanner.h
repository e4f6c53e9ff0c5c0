// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace imomushi {

/// Walks through the lines of a text in memory: \n, \r\n and \r end lines, a byte order mark at the start is skipped.
class LineScanner {
public:
    explicit LineScanner(std::string_view text) : rest_(text) {
        if (rest_.substr(0, 3) == "\xef\xbb\xbf") rest_.remove_prefix(3);
    }
    /// False at the end. `line` is without its ending.
    bool next(std::string_view& line) {
        if (rest_.empty()) return false;
        ++number_;
        const std::size_t end = rest_.find_first_of("\r\n");
        line = rest_.substr(0, end);
        if (end == std::string_view::npos) {
            rest_ = {};
        } else {
            rest_.remove_prefix(end);
            rest_.remove_prefix(rest_.substr(0, 2) == "\r\n" ? 2 : 1);
        }
        return true;
    }
    [[nodiscard]] std::size_t number() const { return number_; }  ///< of the line last given, from 1
    [[nodiscard]] std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// Takes the next word off the front of `line`; empty at its end.
inline std::string_view takeWord(std::string_view& line) {
    const std::size_t begin = line.find_first_not_of(" \t\v\f");
    if (begin == std::string_view::npos) {
        line = {};
        return {};
    }
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\v\f"), line.size());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

/// Without blanks at both ends.
inline std::string_view trimmed(std::string_view s) {
    const std::size_t begin = s.find_first_not_of(" \t\v\f");
    return begin == std::string_view::npos ? std::string_view() : s.substr(begin, s.find_last_not_of(" \t\v\f") - begin + 1);
}

}  // namespace imomushi
