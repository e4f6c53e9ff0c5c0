// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/roll_field.h"

#include <algorithm>
#include <utility>

namespace imomushi {

using Eigen::Matrix3d;

RollField::RollField(const Skeleton& skeleton, const BoneTree& tree, double unit)
    : skeleton_(skeleton), rollSign_(tree.rollSign), branches_(skeleton.points.size(), 0), fixed_(branches_), unit_(unit), rolls_(skeleton.points.size(), Vec3::Zero()) {
    std::vector<std::pair<int, int>> pairs;
    std::vector<int> bones(skeleton.points.size(), 0);
    for (const auto& bone : skeleton.bones) {
        pairs.emplace_back(bone.start, bone.end);
        for (const int point : {bone.start, bone.end})
            if (++bones[point] >= 3) branches_[point] = 1;
    }
    system_ = BlockCholesky<3>(std::vector<int>(skeleton.points.size(), 3), pairs);
}

void RollField::spread(const std::vector<IkGoal>& goals, const std::vector<char>& held, Pose& pose) {
    bool any = std::any_of(pose.roll.begin(), pose.roll.end(), [](double r) { return r != 0.0; });
    for (const auto& goal : goals) {
        any = any || goal.hasRoll;
        if (!goal.hasRoll) continue;
        double sign = 0.0;  // of a bone that ends at the point, or else of one that starts there
        for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
            if (skeleton_.bones[b].end == goal.point) sign = rollSign_[b];
            if (skeleton_.bones[b].start == goal.point && sign == 0.0) sign = rollSign_[b];
        }
        pose.roll[goal.point] = (sign < 0.0 ? -1.0 : 1.0) * goal.roll;
    }
    if (!any) return;
    // A trace of the present roll, which decides only where a tree has no held point.
    constexpr double kKeep = 1e-12;
    const Matrix3d eye = Matrix3d::Identity();
    system_.setZero();
    for (std::size_t i = 0; i < rolls_.size(); ++i) {
        fixed_[i] = held[i] || branches_[i];
        const double weight = fixed_[i] ? 1.0 : kKeep;
        system_.add(static_cast<int>(i), static_cast<int>(i), weight * eye);
        rolls_[i] = Vec3::Constant(weight * pose.roll[i]);
    }
    for (const auto& bone : skeleton_.bones) {
        const double weight = unit_ / bone.length;
        for (const auto& [one, other] : {std::pair(bone.start, bone.end), std::pair(bone.end, bone.start)}) {
            if (fixed_[one]) continue;
            system_.add(one, one, weight * eye);
            if (fixed_[other]) rolls_[one].array() += weight * pose.roll[other];
        }
        if (!fixed_[bone.start] && !fixed_[bone.end]) system_.add(bone.start, bone.end, -weight * eye);
    }
    if (!system_.factorise()) return;
    system_.solve(rolls_);
    for (std::size_t i = 0; i < rolls_.size(); ++i)
        if (!fixed_[i]) pose.roll[i] = rolls_[i].x();
}

}  // namespace imomushi
