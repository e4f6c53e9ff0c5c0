// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/roll_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace imomushi {

using Eigen::Matrix3d;

namespace {

// Torques in units of that of a bone of mean length that is twisted by one radian. The largest of a goal, ...
constexpr double kGoalTorque = 1e4;
// ... which is linear within so many radians; at that torque a bone is so many radians beyond its limit (a degree).
constexpr double kGoalNear = 1e-7, kTwistSlack = 0.0175;
constexpr int kMostSteps = 60;      // the barrier halves its excess in each
constexpr double kStill = 1e-10;    // rad

}  // namespace

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
    limited_ = std::any_of(skeleton.bones.begin(), skeleton.bones.end(), [](const auto& bone) { return bone.limitsTwist(); });
    last_.assign(skeleton.points.size(), 0.0);
    trial_ = wanted_ = last_;
    followed_ = branches_;
}

void RollField::spread(const std::vector<IkGoal>& goals, const std::vector<char>& held, Pose& pose) {
    bool any = std::any_of(pose.roll.begin(), pose.roll.end(), [](double r) { return r != 0.0; });
    if (limited_) {
        last_ = pose.roll;
        std::fill(followed_.begin(), followed_.end(), char(0));
    }
    for (const auto& goal : goals) {
        any = any || goal.hasRoll;
        if (!goal.hasRoll) continue;
        double sign = 0.0;  // of a bone that ends at the point, or else of one that starts there
        for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
            if (skeleton_.bones[b].end == goal.point) sign = rollSign_[b];
            if (skeleton_.bones[b].start == goal.point && sign == 0.0) sign = rollSign_[b];
        }
        pose.roll[goal.point] = (sign < 0.0 ? -1.0 : 1.0) * goal.roll;
        followed_[goal.point] = 1;
        wanted_[goal.point] = pose.roll[goal.point];
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
    const auto beyond = [&](const Skeleton::Bone& bone) { return std::abs(pose.roll[bone.end] - pose.roll[bone.start]) > bone.maxTwist; };
    if (limited_ && std::any_of(skeleton_.bones.begin(), skeleton_.bones.end(), beyond)) keepLimits(pose);
}

double RollField::energyOf(const std::vector<double>& roll) const {
    double sum = 0.0;
    for (const auto& bone : skeleton_.bones) {
        const double twist = roll[bone.end] - roll[bone.start], y = (std::abs(twist) - bone.maxTwist) / kTwistSlack;
        sum += 0.5 * unit_ / bone.length * twist * twist;
        if (bone.limitsTwist() && y > 0.0) sum += kGoalTorque * kTwistSlack * y * y * y / 3.0;
    }
    for (std::size_t i = 0; i < roll.size(); ++i)
        if (followed_[i]) sum += kGoalTorque * std::hypot(roll[i] - wanted_[i], kGoalNear);
    return sum;
}

void RollField::keepLimits(Pose& pose) {
    // A goal gives way, also where limbs branch; what is held without a roll stays.
    for (std::size_t i = 0; i < fixed_.size(); ++i)
        if (followed_[i]) fixed_[i] = 0;
    const Matrix3d eye = Matrix3d::Identity();
    pose.roll = last_;
    double before = energyOf(pose.roll);
    for (int step = 0; step < kMostSteps; ++step) {
        system_.setZero();
        for (std::size_t i = 0; i < rolls_.size(); ++i) {
            const double miss = pose.roll[i] - wanted_[i];
            const double weight = fixed_[i] ? 1.0 : followed_[i] ? kGoalTorque / std::hypot(miss, kGoalNear) : 1e-9;
            system_.add(static_cast<int>(i), static_cast<int>(i), weight * eye);
            rolls_[i] = Vec3::Constant(followed_[i] ? -weight * miss : 0.0);
        }
        for (const auto& bone : skeleton_.bones) {
            const double twist = pose.roll[bone.end] - pose.roll[bone.start], y = (std::abs(twist) - bone.maxTwist) / kTwistSlack;
            double weight = unit_ / bone.length, torque = weight * twist;
            if (bone.limitsTwist() && y > 0.0) {
                weight += 2.0 * kGoalTorque * y / kTwistSlack;
                torque += std::copysign(kGoalTorque * y * y, twist);
            }
            if (!fixed_[bone.start]) system_.add(bone.start, bone.start, weight * eye), rolls_[bone.start].array() += torque;
            if (!fixed_[bone.end]) system_.add(bone.end, bone.end, weight * eye), rolls_[bone.end].array() -= torque;
            if (!fixed_[bone.start] && !fixed_[bone.end]) system_.add(bone.start, bone.end, -weight * eye);
        }
        if (!system_.factorise()) return;
        system_.solve(rolls_);
        double part = 1.0, most = 0.0, energy = before;
        for (std::size_t i = 0; i < rolls_.size(); ++i) most = std::max(most, fixed_[i] ? 0.0 : std::abs(rolls_[i].x()));
        if (!(most > kStill)) return;
        for (int half = 0; half < 30; ++half, part *= 0.5) {
            for (std::size_t i = 0; i < rolls_.size(); ++i) trial_[i] = pose.roll[i] + (fixed_[i] ? 0.0 : part * rolls_[i].x());
            energy = energyOf(trial_);
            if (energy <= before) break;
        }
        if (!(energy <= before)) return;
        pose.roll.swap(trial_);
        before = energy;
    }
}

}  // namespace imomushi
