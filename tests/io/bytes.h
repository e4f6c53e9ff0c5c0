// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

namespace imomushi::io_test {

/// Adds a number as it is in memory; `swap`: in the other order of bytes.
template <class T>
void put(std::string& bytes, T value, bool swap = false) {
    char b[sizeof(T)];
    std::memcpy(b, &value, sizeof b);
    if (swap) std::reverse(b, b + sizeof b);
    bytes.append(b, sizeof b);
}

}  // namespace imomushi::io_test
