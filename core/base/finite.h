// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace imomushi {

/// Neither infinite nor NaN. By its bits, so that no floating-point exception is raised: comparing a signalling NaN would trap.
inline bool isFinite(double value) { return (std::bit_cast<std::uint64_t>(value) & 0x7ff0000000000000u) != 0x7ff0000000000000u; }
inline bool isFinite(float value) { return (std::bit_cast<std::uint32_t>(value) & 0x7f800000u) != 0x7f800000u; }

/// All of them. Eigen's own allFinite() subtracts infinities, which traps.
template <class Scalar>
bool allFinite(const Scalar* values, std::size_t count) {
    return std::all_of(values, values + count, [](Scalar x) { return isFinite(x); });
}

template <class Scalar>
bool allFinite(const std::vector<Scalar>& values) {
    return allFinite(values.data(), values.size());
}

template <class Dense>
bool allFinite(const Eigen::DenseBase<Dense>& numbers) {
    for (Eigen::Index c = 0; c < numbers.cols(); ++c)
        for (Eigen::Index r = 0; r < numbers.rows(); ++r)
            if (!isFinite(numbers.derived().coeff(r, c))) return false;
    return true;
}

}  // namespace imomushi
