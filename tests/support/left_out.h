// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <atomic>
#include <string>

namespace imomushi {

/// Parts that this program left out so far.
inline std::atomic<int> partsLeftOut = 0;

/// Says that a part of a case cannot be done on this machine. ctest lists the test as skipped then, unless another part of it fails: what was not looked at has not passed.
inline void leaveOut(const std::string& why) {
    ++partsLeftOut;
    MESSAGE("left out: ", why);
}

/// What main() returns, by what doctest says.
inline int statusOf(int doctest) {
    constexpr int kSkipped = 77;  // SKIP_RETURN_CODE of tests/CMakeLists.txt and tests/discover.cmake
    return doctest == 0 && partsLeftOut > 0 ? kSkipped : doctest;
}

}  // namespace imomushi
