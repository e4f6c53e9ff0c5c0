// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/bone_limits.h"

#include <cmath>

namespace imomushi {

namespace {

/// A bone is at its limit in the last part of the way to it: limits are soft.
constexpr double kLastPart = 0.05;
/// Bones that hardly change their length are always at its limits, and say nothing.
constexpr double kLeastRoom = 0.02;

}  // namespace

BoneLimit limitOf(const Skeleton& skeleton, const Pose& pose, int index) {
    if (pose.points.size() != skeleton.points.size() || pose.frames.size() != skeleton.bones.size()) return BoneLimit::None;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    const Skeleton::Bone& bone = skeleton.bones[at(index)];
    const Vec3 along = pose.points[at(bone.end)] - pose.points[at(bone.start)];
    const double stretch = along.norm() / bone.length, room = bone.maxStretch - 1.0, shortest = 1.0 - bone.minStretch;
    if (room > kLeastRoom && stretch > 1.0 + (1.0 - kLastPart) * room) return BoneLimit::Stretched;
    if (shortest > kLeastRoom && stretch < 1.0 - (1.0 - kLastPart) * shortest) return BoneLimit::Shortened;
    if (!bone.limitsBend() || bone.parent < 0) return BoneLimit::None;
    const Vec3 carried = pose.frames[at(bone.parent)] * (skeleton.points[at(bone.end)] - skeleton.points[at(bone.start)]);
    const double angle = std::atan2(carried.cross(along).norm(), carried.dot(along));
    return angle > (1.0 - kLastPart) * bone.maxBend ? BoneLimit::Bent : BoneLimit::None;
}

}  // namespace imomushi
