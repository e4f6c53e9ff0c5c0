// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>

namespace imomushi {

/// Whether packaging/thorough.sh runs the tests (IMOMUSHI_THOROUGH).
inline bool thorough() {
    const char* set = std::getenv("IMOMUSHI_THOROUGH");
    return set && *set;
}

/// How often a test of chance repeats: `usual`, or `all` of its bar.
inline int repeats(int usual, int all) { return thorough() ? all : usual; }

}  // namespace imomushi
