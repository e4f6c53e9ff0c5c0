// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace imomushi {

/// No infinity and no NaN among the numbers. Raises no floating-point exception, unlike Eigen's own allFinite(), which subtracts infinities.
template <class Scalar>
bool allFinite(const Scalar* values, std::size_t count) {
    return std::all_of(values, values + count, [](Scalar x) { return std::isfinite(x); });
}

template <class Dense>
bool allFinite(const Eigen::DenseBase<Dense>& numbers) {
    for (Eigen::Index c = 0; c < numbers.cols(); ++c)
        for (Eigen::Index r = 0; r < numbers.rows(); ++r)
            if (!std::isfinite(numbers.derived().coeff(r, c))) return false;
    return true;
}

}  // namespace imomushi
