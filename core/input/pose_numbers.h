// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <span>

namespace imomushi {

/// Channels that say poses have ten numbers (vmc_decoder.cpp): a place x y z (m), a rotation x y z w (unit), the same as a rotation vector x y z (radians).
inline constexpr int kPoseNumbers = 10, kPoseRotation = 3, kPoseTurn = 7;

inline Eigen::Map<const Eigen::Vector4d> rotationIn(std::span<const double> pose) { return Eigen::Map<const Eigen::Vector4d>(pose.data() + kPoseRotation); }

/// Such a channel says them; rotations may have been rounded or averaged.
inline bool saysPose(std::span<const double> numbers) {
    constexpr double kUnit = 1e-3;  // how far a length may be from 1
    return numbers.size() == static_cast<std::size_t>(kPoseNumbers) && std::abs(rotationIn(numbers).norm() - 1.0) < kUnit;
}

}  // namespace imomushi
