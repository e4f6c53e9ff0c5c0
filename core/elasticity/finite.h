// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace imomushi {

/// No infinity and no NaN in a vector or matrix that lies in one piece of memory. Eigen's allFinite() subtracts infinities, which raises a
/// floating-point exception.
template <class Numbers>
bool finite(const Numbers& numbers) {
    return std::all_of(numbers.data(), numbers.data() + numbers.size(), [](auto x) { return std::isfinite(x); });
}

}  // namespace imomushi
