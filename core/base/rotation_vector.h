// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "core/base/vec3.h"

namespace imomushi {

/// The rotation by |v| radians about v; zero: none.
inline Eigen::Quaterniond rotationOf(const Vec3& v) {
    const double angle = v.norm();
    if (!(angle > 0.0)) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

/// The other way, 0 ... pi radians long. `turn`: unit.
inline Vec3 rotationVector(const Eigen::Quaterniond& turn) {
    const Vec3 sine = turn.w() < 0.0 ? Vec3(-turn.vec()) : Vec3(turn.vec());
    const double half = sine.norm();
    if (!(half > 0.0)) return Vec3::Zero();
    return 2.0 * std::atan2(half, std::abs(turn.w())) / half * sine;
}

}  // namespace imomushi
