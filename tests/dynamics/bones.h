// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/dynamics/bone_dynamics.h"
#include "tests/dynamics/skeletons.h"

namespace imomushi {

constexpr double kFrame = 1.0 / 60.0;

inline BoneDynamics::Input inputOf(const Skeleton& s, const BoneSpring& spring = {}) {
    BoneDynamics::Input input;
    input.skeleton = s;
    input.mass.assign(s.points.size(), 1.0);
    input.settings.springs = {spring};
    return input;
}

inline BoneDynamics make(const Skeleton& s, const BoneSpring& spring = {}) { return BoneDynamics::build(inputOf(s, spring)).value(); }

inline double farthestFrom(const Pose& a, const Pose& b) {
    double m = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i) m = std::max(m, (a.points[i] - b.points[i]).norm());
    return m;
}

inline void checkFinite(const Pose& pose) {
    for (const auto& p : pose.points) REQUIRE(allFinite(p));
    for (const auto& q : pose.frames) REQUIRE(allFinite(q.coeffs()));
    for (const double r : pose.roll) REQUIRE(std::isfinite(r));
}

}  // namespace imomushi
