// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace imomushi {

/// A hash of the names of a source and of a channel of it: FNV-1a.
inline std::uint64_t hashOfNames(std::string_view source, std::string_view channel) {
    std::uint64_t hash = 14695981039346656037u;
    const auto add = [&hash](char c) { hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u; };
    for (const char c : source) add(c);
    add('\n');
    for (const char c : channel) add(c);
    return hash;
}

}  // namespace imomushi
