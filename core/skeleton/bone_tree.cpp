// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/bone_tree.h"

#include <cmath>

namespace imomushi {

BoneTree boneTree(const Skeleton& skeleton) {
    const auto& bones = skeleton.bones;
    BoneTree out;
    for (int b = 0; b < static_cast<int>(bones.size()); ++b) {
        const auto& bone = bones[b];
        const Vec3 along = skeleton.points[bone.end] - skeleton.points[bone.start];
        const double length = along.norm();
        out.restDirection.push_back(length > 0.0 ? Vec3(along / length) : Vec3(Vec3::UnitX()));

        int parent = bone.parent < b ? bone.parent : -1;
        for (int other = 0; parent < 0 && other < b; ++other)
            for (const int p : {bones[other].start, bones[other].end})
                if (p == bone.start || p == bone.end) parent = other;
        out.parent.push_back(parent);
        out.tree.push_back(parent < 0 ? b : out.tree[parent]);

        double sign = 1.0;
        if (parent >= 0) {
            const bool sameEnds = bone.start == bones[parent].start || bone.end == bones[parent].end;
            const bool opposite = out.restDirection[b].dot(out.restDirection[parent]) < 0.0;
            sign = out.rollSign[parent] * (sameEnds && opposite ? -1.0 : 1.0);
        }
        out.rollSign.push_back(sign);
    }
    return out;
}

Eigen::Quaterniond minimalRotation(const Vec3& from, const Vec3& to) {
    const double w = 1.0 + from.dot(to);
    // Below this the cross product is all rounding.
    constexpr double kOpposite = 1e-14;
    if (w < kOpposite) {
        int least = 0;
        from.cwiseAbs().minCoeff(&least);
        const Vec3 axis = from.cross(Vec3::Unit(least)).normalized();
        return {0.0, axis.x(), axis.y(), axis.z()};
    }
    const Vec3 axis = from.cross(to);
    return Eigen::Quaterniond(w, axis.x(), axis.y(), axis.z()).normalized();
}

bool fits(const Skeleton& skeleton, const Pose& pose) {
    const std::size_t points = skeleton.points.size();
    if (pose.points.size() != points || pose.roll.size() != points || pose.frames.size() != skeleton.bones.size()) return false;
    for (const auto& p : pose.points)
        if (!allFinite(p)) return false;
    for (const auto& q : pose.frames)
        if (!allFinite(q.coeffs()) || !(q.coeffs().cwiseAbs().maxCoeff() < 2.0) || !(q.squaredNorm() > 0.5)) return false;
    for (const double r : pose.roll)
        if (!std::isfinite(r)) return false;
    return true;
}

double boneRoll(const Skeleton& skeleton, const BoneTree& tree, const Pose& pose, int bone) {
    const auto& b = skeleton.bones[bone];
    return tree.rollSign[bone] * 0.5 * (pose.roll[b.start] + pose.roll[b.end]);
}

}  // namespace imomushi
