// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/utf8.h"

namespace imomushi {

std::size_t utf8Length(std::string_view s, std::size_t at) {
    const auto byte = [&](std::size_t i) { return at + i < s.size() ? static_cast<unsigned char>(s[at + i]) : 0U; };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
    const unsigned first = byte(0);
    if (first < 0x80U) return 1;
    if (first >= 0xC2U && first <= 0xDFU && follows(1)) return 2;
    if (first >= 0xE0U && first <= 0xEFU && follows(1) && follows(2)) {
        const unsigned code = (first & 0x0FU) << 12 | (byte(1) & 0x3FU) << 6 | (byte(2) & 0x3FU);
        return code >= 0x800U && (code < 0xD800U || code > 0xDFFFU) ? 3 : 0;
    }
    if (first >= 0xF0U && first <= 0xF4U && follows(1) && follows(2) && follows(3)) {
        const unsigned code = (first & 0x07U) << 18 | (byte(1) & 0x3FU) << 12;
        return code >= 0x10000U && code <= 0x10FFFFU ? 4 : 0;
    }
    return 0;
}

bool isUtf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8Length(text, at);
        if (length == 0) return false;
        at += length;
    }
    return true;
}

}  // namespace imomushi
