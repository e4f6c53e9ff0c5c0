// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/calibration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/decompositions.h"

namespace imomushi {

namespace {

using Turns = std::span<const SaidAndMeant<Eigen::Quaterniond>>;

/// What is nearer to the vertical than this is no way across: a part of the length of a quaternion.
constexpr double kNoFacing = 1e-6;
/// How much what was there before counts where poses tell nothing about it.
constexpr double kPrior = 1e-7;
constexpr double kFarthestReach = 3.0;  // radians

/// The rotation r with the largest tr(r^T m).
Eigen::Quaterniond nearestRotation(const Eigen::Matrix3d& m) {
    const SingularValues found = singularValuesOf(m);
    Eigen::Matrix3d u = found.u;
    if ((u * found.v.transpose()).determinant() < 0.0) u.col(2) *= -1.0;
    return Eigen::Quaterniond(Eigen::Matrix3d(u * found.v.transpose())).normalized();
}

/// How one pose is turned against another one.
Vec3 turnFrom(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return rotationVector(b * a.conjugate()); }

/// The poses that differ from the first one, in what is said and in what is meant.
std::vector<SaidAndMeant<Vec3>> turnsFromFirst(Turns poses) {
    std::vector<SaidAndMeant<Vec3>> made;
    for (const auto& pose : poses.subspan(1)) {
        const SaidAndMeant<Vec3> turn{turnFrom(poses[0].said, pose.said), turnFrom(poses[0].meant, pose.meant)};
        if (turn.said.norm() > kTurnTells && turn.meant.norm() > kTurnTells) made.push_back(turn);
    }
    return made;
}

}  // namespace

Eigen::Quaterniond facingOf(const Eigen::Quaterniond& turn) {
    const double length = std::hypot(turn.w(), turn.y());
    if (length < kNoFacing) return Eigen::Quaterniond::Identity();
    return {turn.w() / length, 0.0, turn.y() / length, 0.0};
}

Correction fitTurn(Turns poses, bool inRoom) {
    Correction made;
    made.kind = Correction::Kind::Turn;
    if (poses.empty()) return made;
    Eigen::Quaterniond& before = made.before;
    if (inRoom) {
        Eigen::Matrix3d off = Eigen::Matrix3d::Zero();
        for (const auto& pose : poses) off += facingOf(pose.said * pose.meant.conjugate()).toRotationMatrix();
        before = facingOf(nearestRotation(off)).conjugate();
    }
    const auto turns = turnsFromFirst(poses);
    made.after = (before * poses[0].said).conjugate();
    if (!turns.empty()) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const auto& turn : turns) sum += turn.meant * turn.said.transpose();
        // The prior of the second round has what poses tell, and takes nothing away from it.
        for (int round = 0; round < 2; ++round) before = nearestRotation(sum + kPrior * sum.norm() * before.toRotationMatrix());
        made.after = (before * poses[0].said).conjugate();
        double along = 0.0, square = 0.0;
        made.reach = 0.0;
        for (const auto& turn : turns) {
            along += (before * turn.said).dot(turn.meant);
            square += turn.said.squaredNorm();
            made.reach = std::max(made.reach, turn.said.norm());
        }
        made.gain = std::clamp(along / square, 1.0 / kLargestTurnGain, kLargestTurnGain);
        made.reach = std::min(made.reach, kFarthestReach);
    }
    // What is left is shared by all poses.
    Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
    for (const auto& pose : poses) left += (made.amplified(before * pose.said * made.after).conjugate() * pose.meant).toRotationMatrix();
    made.last = poses.size() == 1 ? poses[0].meant : nearestRotation(left);
    return made;
}

Correction fitPlace(std::span<const SaidAndMeant<Vec3>> poses, const Eigen::Quaterniond& facing, double tells) {
    Correction made;
    made.kind = Correction::Kind::Place;
    made.before = facing;
    if (poses.empty()) return made;
    Vec3 said = Vec3::Zero(), meant = Vec3::Zero();
    for (const auto& pose : poses) said += pose.said, meant += pose.meant;
    said /= static_cast<double>(poses.size()), meant /= static_cast<double>(poses.size());
    double saidWay = 0.0, meantWay = 0.0, saidAcross = 0.0, meantAcross = 0.0;
    const auto across = [](const Vec3& v) { return std::hypot(v.x(), v.z()); };
    for (const auto& a : poses)
        for (const auto& b : poses) {
            saidWay = std::max(saidWay, (a.said - b.said).norm()), meantWay = std::max(meantWay, (a.meant - b.meant).norm());
            saidAcross = std::max(saidAcross, across(a.said - b.said)), meantAcross = std::max(meantAcross, across(a.meant - b.meant));
        }
    if (saidWay > tells && meantWay > tells) {
        if (saidAcross > tells && meantAcross > tells) {
            double cosine = 0.0, sine = 0.0;
            for (const auto& pose : poses) {
                const Vec3 s = pose.said - said, m = pose.meant - meant;
                cosine += s.x() * m.x() + s.z() * m.z();
                sine += s.z() * m.x() - s.x() * m.z();
            }
            if (std::hypot(cosine, sine) > 0.0) made.before = rotationOf(Vec3(0.0, std::atan2(sine, cosine), 0.0));
        }
        double along = 0.0, square = 0.0;
        for (const auto& pose : poses) {
            along += (made.before * (pose.said - said)).dot(pose.meant - meant);
            square += (pose.said - said).squaredNorm();
        }
        made.gain = std::clamp(along / square, 1.0 / kLargestGain, kLargestGain);
    }
    made.by = meant - made.gain * (made.before * said);
    return made;
}

Correction fitNumber(std::span<const SaidAndMeant<double>> poses, double tells) {
    Correction made;
    if (poses.empty()) return made;
    double said = 0.0, meant = 0.0;
    for (const auto& pose : poses) said += pose.said, meant += pose.meant;
    said /= static_cast<double>(poses.size()), meant /= static_cast<double>(poses.size());
    double saidWay = 0.0, meantWay = 0.0, along = 0.0, square = 0.0;
    for (const auto& a : poses) {
        for (const auto& b : poses) saidWay = std::max(saidWay, std::abs(a.said - b.said)), meantWay = std::max(meantWay, std::abs(a.meant - b.meant));
        along += (a.said - said) * (a.meant - meant);
        square += (a.said - said) * (a.said - said);
    }
    if (saidWay > tells && meantWay > tells) made.gain = std::copysign(std::clamp(std::abs(along / square), 1.0 / kLargestGain, kLargestGain), along);
    made.by.x() = meant - made.gain * said;
    return made;
}

}  // namespace imomushi
