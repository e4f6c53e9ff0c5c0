// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/base/rotation_vector.h"

namespace imomushi {

/// What makes of the numbers that a source says those that it would say if it stood, and was worn, as the character is. See calibration.h, which finds it.
struct Correction {
    enum class Kind : std::uint8_t {
        Number,  ///< gain * number + by.x
        Place,   ///< gain * (before turns three numbers) + by
        Turn     ///< (before * turn * after)^gain * last, of a rotation vector of three numbers
    } kind = Kind::Number;
    int first = 0;           ///< which number of the channel, or the first of three
    double gain = 1.0;
    double radians = 1.0;    ///< of a turn: what 1 stands for
    double reach = 3.0;      ///< of a turn, radians, below pi: so far the gain holds; from there on it fades, so that half a turn is half a turn, from either side
    Vec3 by = Vec3::Zero();
    Eigen::Quaterniond before = Eigen::Quaterniond::Identity(), after = Eigen::Quaterniond::Identity(), last = Eigen::Quaterniond::Identity();

    /// What a number of the channel becomes; one that is not corrected stays. Neither allocates nor fails. `numbers`: finite; those that are missing count as 0.
    [[nodiscard]] double at(std::span<const double> numbers, int component) const {
        const auto said = [&](int index) { return static_cast<std::size_t>(index) < numbers.size() ? numbers[static_cast<std::size_t>(index)] : 0.0; };
        const int axis = component - first;
        if (axis < 0 || axis > (kind == Kind::Number ? 0 : 2)) return said(component);
        if (kind == Kind::Number) return gain * said(first) + by.x();
        const Vec3 three(said(first), said(first + 1), said(first + 2));
        if (kind == Kind::Place) return (gain * (before * three) + by)[axis];
        return rotationVector((amplified(before * rotationOf(radians * three) * after) * last).normalized())[axis] / radians;
    }

    /// A turn with the gain.
    [[nodiscard]] Eigen::Quaterniond amplified(const Eigen::Quaterniond& turn) const {
        if (gain == 1.0) return turn;
        const Vec3 v = rotationVector(turn.normalized());
        const double angle = v.norm(), end = std::min(gain * reach, std::numbers::pi);
        if (!(angle > 0.0)) return turn;
        const double goes = angle <= reach ? end / reach * angle : end + (std::numbers::pi - end) * (angle - reach) / (std::numbers::pi - reach);
        return rotationOf(goes / angle * v);
    }
};

}  // namespace imomushi
