// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>

namespace imomushi {

/// How often a test of chance repeats: `usual`, or `all` of its bar where packaging/thorough.sh runs it (IMOMUSHI_THOROUGH).
inline int repeats(int usual, int all) {
    const char* thorough = std::getenv("IMOMUSHI_THOROUGH");
    return thorough && *thorough ? all : usual;
}

}  // namespace imomushi
