// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/dynamics/bone_dynamics.h"
#include "core/skeleton/bone_tree.h"
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

// The kinematic pose of a chain that is carried about and curled, as a function of time alone.
inline Pose curled(const Skeleton& s, double time) {
    Pose pose = restPose(s);
    const BoneTree tree = boneTree(s);
    pose.points[0] = Vec3(0.5 * std::sin(4.0 * time), 0.3 * std::sin(6.0 * time), 0.0);
    const double bend = 0.35 * std::sin(5.0 * time), twist = 0.8 * std::sin(3.0 * time);
    Eigen::Quaterniond frame(Eigen::AngleAxisd(0.4 * std::sin(2.0 * time), Vec3::UnitY()));
    for (std::size_t b = 0; b < s.bones.size(); ++b) {
        frame = frame * Eigen::Quaterniond(Eigen::AngleAxisd(bend, Vec3::UnitZ()));
        pose.frames[b] = frame;
        const double length = s.bones[b].length * (1.0 + 0.1 * std::sin(7.0 * time));
        pose.points[b + 1] = pose.points[b] + length * (frame * tree.restDirection[b]);
        pose.roll[b + 1] = twist * static_cast<double>(b + 1);
    }
    return pose;
}

}  // namespace imomushi
