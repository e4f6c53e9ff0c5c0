// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/finite.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Connectivity of the bones of a skeleton, derived once and shared by inverse kinematics and characters. One entry per bone.
struct BoneTree {
    /// The bone whose frame is transported to this one: Skeleton::Bone::parent, or else the first earlier bone at a common
    /// joint point (an artist need not name parents along a chain); -1: a root. Always smaller than the bone's own index.
    std::vector<int> parent;
    std::vector<int> tree;            ///< index of its root bone: frames of one tree have consistent quaternion signs
    std::vector<Vec3> restDirection;  ///< unit, start -> end
    /// +1 or -1: the sense in which a bone counts roll. Roll is one number per joint point, so that of a chain which leaves its
    /// root in two opposite directions one half counts it about the reversed bone.
    std::vector<double> rollSign;
};

/// The joint points of two bones that meet, each once, and how the vectors along the two change with them: -1 at its start, +1 at its end.
struct BendPoints {
    int count = 0;
    int point[4] = {};
    double onParent[4] = {}, onChild[4] = {};

    void add(int to, double parent, double child) {
        int i = 0;
        while (i < count && point[i] != to) ++i;
        count = std::max(count, i + 1);
        point[i] = to;
        onParent[i] += parent;
        onChild[i] += child;
    }
};

BoneTree boneTree(const Skeleton& skeleton);

/// The rotation of least angle that takes the unit vector `from` to the unit vector `to`; real part >= 0. Opposite vectors: half a turn
/// about some axis across them.
Eigen::Quaterniond minimalRotation(const Vec3& from, const Vec3& to);

/// A pose of `skeleton` that can be used: right sizes, finite, unit frames to a factor of about two.
bool fits(const Skeleton& skeleton, const Pose& pose);

/// Roll of a bone in radians about its direction: the mean of its two ends.
double boneRoll(const Skeleton& skeleton, const BoneTree& tree, const Pose& pose, int bone);

}  // namespace imomushi
