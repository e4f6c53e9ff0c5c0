// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "tests/memory/failing_malloc.h"
#include "tests/support/thorough.h"

namespace imomushi {

using Fails = FailingMalloc::Fails;
inline constexpr Fails kWays[] = {Fails::Once, Fails::FromThenOn};

/// The next n to try after n: the first ones each, in thorough runs 2,000 of them, then ever fewer. Where all from n on fail the command ends early, whatever n is.
inline long after(long n, Fails fails) {
    const bool once = fails == Fails::Once;
    return n + (n < repeats(once ? 40 : 10, 2000) ? 1 : std::max(1L, n / (once ? 8 : 3)));
}

inline const char* named(Fails fails) { return fails == Fails::Once ? "request " : "all requests from "; }

}  // namespace imomushi
