// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/standard_poses.h"

#include <numbers>

#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// What a bone does relative to its parent.
struct Joint {
    double stretch = 1.0;
    Eigen::Quaterniond bend = Eigen::Quaterniond::Identity();  // across the bone, real part > 0
    double roll = 0.0;
};

template <class Choose>
Pose posed(const Skeleton& skeleton, Choose choose) {
    const BoneTree tree = boneTree(skeleton);
    Pose pose = restPose(skeleton);
    std::vector<char> placed(skeleton.points.size(), 0);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        const int parent = tree.parent[b];
        if (parent < 0) placed[static_cast<std::size_t>(bone.start)] = 1;
        const bool forward = placed[static_cast<std::size_t>(bone.start)] != 0;
        const auto from = static_cast<std::size_t>(forward ? bone.start : bone.end), to = static_cast<std::size_t>(forward ? bone.end : bone.start);
        const Joint joint = choose(parent < 0, tree.restDirection[b]);
        if (parent >= 0) pose.frames[b] = pose.frames[static_cast<std::size_t>(parent)] * joint.bend;
        pose.roll[to] = pose.roll[from] + joint.roll;
        pose.points[to] = pose.points[from] + joint.stretch * (pose.frames[b] * (skeleton.points[to] - skeleton.points[from]));
        placed[to] = placed[from] = 1;
    }
    return pose;
}

Eigen::Quaterniond bendAcross(const Vec3& direction, double angle, double about) {
    const Vec3 side = direction.unitOrthogonal();
    const Vec3 axis = std::cos(about) * side + std::sin(about) * direction.cross(side);
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

/// Numbers in [-1, 1] that are the same on every machine.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
    double operator()() {
        state_ ^= state_ << 13, state_ ^= state_ >> 7, state_ ^= state_ << 17;
        return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
    }

private:
    std::uint64_t state_;
};

}  // namespace

std::vector<StandardPose> standardPoses(const Skeleton& skeleton) {
    std::vector<StandardPose> out;
    out.push_back({"stretch", posed(skeleton, [](bool, const Vec3&) { return Joint{1.2}; })});
    out.push_back({"bend", posed(skeleton, [](bool, const Vec3& d) { return Joint{1.0, bendAcross(d, 30.0 * kDegree, 0.0)}; })});
    out.push_back({"twist", posed(skeleton, [](bool, const Vec3&) { return Joint{1.0, Eigen::Quaterniond::Identity(), 20.0 * kDegree}; })});
    for (int i = 1; i <= 3; ++i) {
        Random random(static_cast<std::uint64_t>(i));
        out.push_back({"random " + std::to_string(i), posed(skeleton, [&](bool, const Vec3& d) {
                           const double stretch = 1.0 + 0.15 * random(), angle = 25.0 * kDegree * random(), about = std::numbers::pi * random();
                           return Joint{stretch, bendAcross(d, angle, about), 10.0 * kDegree * random()};
                       })});
    }
    return out;
}

}  // namespace imomushi
