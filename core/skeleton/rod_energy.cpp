// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/rod_energy.h"

#include <algorithm>
#include <cmath>

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// Bending stiffness, as a torque per force: bodies bend before they stretch. At the largest force of a target the discrete curvature lets two bones fold to
// about 160 degrees.
constexpr double kBendStiffness = 0.05;
// The force of a target spring saturates here, ...
constexpr double kGoalForce = 50.0;
// ... is linear within this part of the mean bone length (a reachable target is missed by a fiftieth of it per unit of force), ...
constexpr double kGoalReach = 1e-6;
// ... and falls to this part of itself beyond kFarGoal mean bone lengths: several targets out of reach do not tear a point from its own.
constexpr double kFarPull = 0.1;
constexpr double kFarGoal = 0.1;
// The force at which a bone is kLimitSlack rest lengths beyond its stretch limits.
constexpr double kLimitForce = 10.0;
constexpr double kLimitSlack = 0.01;
// At a torque of the largest force of a target at an arm as long as the skeleton, a joint is this far beyond its bend limit, and a held bone away from its direction (of the
// discrete curvature, a degree).
constexpr double kBendSlack = 0.0175;
// Load across a compressed bone, which gives a straight body a side to buckle to. None where the discrete curvature at its ends is above kStraight, so that
// a bent body comes to rest.
constexpr double kSideForce = 1e-3;
constexpr double kStraight = 0.05;

// Stiffness of a hinge across its axis and backwards, over that about it.
constexpr double kHinge = 4.0;
// The same of a hinge that is straighter than what lets its bones have their rest lengths: bones fold before they squash, and limbs before the trunk moves. A human figure whose wrist goes 60 % of the
// way to its shoulder moves that by 7 % of its height; at 1 by 13 %.
constexpr double kFold = 8.0;
constexpr double kMostFold = 2.6;  // rad

// Nearer to the opposite of a direction than this (1 plus the cosine: .08 degrees) there is hardly a torque to a side, and none at all there: it is taken as that far.
constexpr double kOpposite = 1e-6;

// The unit vector t, or one beside the opposite of d where t is nearer to that: on the side of t, or else on that of `side` (unit, across d).
Vec3 besideOpposite(const Vec3& t, const Vec3& d, const Vec3& side) {
    if (1.0 + t.dot(d) >= kOpposite) return t;
    const Vec3 across = t - t.dot(d) * d;
    return (std::sqrt(2.0 * kOpposite) * (across.norm() > 1e-12 ? Vec3(across.normalized()) : side) - d).normalized();
}

// The cross product as a matrix.
Matrix3d cross(const Vec3& a) {
    Matrix3d m;
    m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return m;
}

}  // namespace

RodEnergy::RodEnergy(const Skeleton& skeleton) : skeleton_(skeleton), tree_(boneTree(skeleton)) {
    const int points = static_cast<int>(skeleton.points.size()), bones = static_cast<int>(skeleton.bones.size());
    for (const auto& p : skeleton.points) size_ = std::max(size_, (p - skeleton.points[0]).norm());
    for (const auto& b : skeleton.bones) unit_ += b.length / bones;
    if (bones == 0) unit_ = size_ > 0.0 ? size_ : 1.0;
    size_ = std::max(size_, unit_);

    for (int b = 0; b < bones; ++b) {
        const auto& bone = skeleton_.bones[b];
        pairs_.emplace_back(bone.start, bone.end);
        Vec3 across = Vec3::UnitY() - tree_.restDirection[b].y() * tree_.restDirection[b];
        if (across.norm() < 0.1) across = Vec3::UnitX() - tree_.restDirection[b].x() * tree_.restDirection[b];
        restSide_.push_back(across.normalized());
        if (tree_.parent[b] < 0) continue;
        Bend bend;
        bend.parent = tree_.parent[b];
        bend.child = b;
        const auto& parent = skeleton_.bones[bend.parent];
        bend.stiffness = bone.swing * bone.stiffness * kBendStiffness * 0.5 * (bone.length + parent.length);
        bend.limited = bone.limitsBend();
        if (bend.limited) bend.limit = 2.0 * std::tan(0.5 * bone.maxBend);
        bend.add(parent.start, -1, 0), bend.add(parent.end, 1, 0), bend.add(bone.start, 0, -1), bend.add(bone.end, 0, 1);
        for (int i = 0; i < bend.count; ++i)
            for (int j = 0; j < i; ++j) pairs_.emplace_back(bend.point[i], bend.point[j]);
        if (bone.hinge.squaredNorm() > 0.0 && bend.count == 3) {
            Hinge& hinge = bend.hinge;
            hinge.is = true;
            hinge.slack = bone.foldSlack;
            hinge.joint = bone.start == parent.start || bone.start == parent.end ? bone.start : bone.end;
            hinge.root = parent.start + parent.end - hinge.joint;
            hinge.tip = bone.start + bone.end - hinge.joint;
            const Vec3 above = skeleton.points[hinge.joint] - skeleton.points[hinge.root], below = skeleton.points[hinge.tip] - skeleton.points[hinge.joint];
            hinge.upper = above.norm(), hinge.lower = below.norm(), hinge.apart = (above + below).norm();
            hinge.angle = std::atan2(above.cross(below).norm(), above.dot(below));
            const Vec3 side = below.cross(bone.hinge);  // to where the joint goes
            if (side.norm() > 1e-6 * hinge.lower) restSide_[static_cast<std::size_t>(bend.child)] = restSide_[static_cast<std::size_t>(bend.parent)] = side.normalized();
        }
        bends_.push_back(bend);
    }
    x_.assign(points, Vec3::Zero());
    gradient_ = side_ = x_;
    frames_.assign(bones, Quaterniond::Identity());
    direction_.assign(bones, Vec3::UnitX());
    bent_.assign(bends_.size(), Vec3::UnitX());
    fold_.assign(bends_.size(), 0.0);
    axis_.assign(bends_.size(), Vec3::UnitX());
    bend2_.assign(bones, 0.0);
    natural_.assign(bones, 1.0);
}

Vec3 RodEnergy::along(int b, const std::vector<Vec3>& points) const {
    return points[skeleton_.bones[b].end] - points[skeleton_.bones[b].start];
}

Vec3 RodEnergy::directionOf(int b, const std::vector<Vec3>& points, const Quaterniond& frame) const {
    const Vec3 v = along(b, points);
    const double length = v.norm();
    if (length > 1e-9 * skeleton_.bones[b].length) return v / length;
    return frame * tree_.restDirection[b];
}

void RodEnergy::transport(const std::vector<Vec3>& points, const std::vector<Quaterniond>& from, std::vector<Quaterniond>& to) const {
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        const int parent = tree_.parent[b];
        const Quaterniond base = parent < 0 ? from[b] : to[parent];
        const Vec3 d = directionOf(static_cast<int>(b), points, from[b]);
        to[b] = (minimalRotation(base * tree_.restDirection[b], d) * base).normalized();
    }
}

RodEnergy::Tension RodEnergy::stretch(std::size_t b, double length) const {
    const auto& bone = skeleton_.bones[b];
    const double strain = length / bone.length - 1.0, fromNatural = length / bone.length - natural_[b];
    Tension r{bone.stiffness * fromNatural, bone.stiffness / bone.length, bone.stiffness * 0.5 * fromNatural * fromNatural * bone.length};
    const double low = std::max(bone.minStretch, 0.02) - 1.0, high = std::max(bone.maxStretch, 0.03) - 1.0;
    for (const double excess : {strain - high, low - strain}) {
        if (excess <= 0.0) continue;
        const double sign = strain > high ? 1.0 : -1.0, y = excess / kLimitSlack;
        r.force += sign * kLimitForce * y * y;
        r.slope += 2.0 * kLimitForce * y / (kLimitSlack * bone.length);
        r.energy += kLimitForce * kLimitSlack * bone.length * y * y * y / 3.0;
    }
    return r;
}

double RodEnergy::folded(const Hinge& hinge, double apart) {
    const double shorter = 1.0 - apart / hinge.apart;
    if (!(shorter > 0.0)) return 0.0;
    const double to = hinge.apart * (1.0 - shorter * shorter / (shorter + hinge.slack));
    const double cosine = (to * to - hinge.upper * hinge.upper - hinge.lower * hinge.lower) / (2.0 * hinge.upper * hinge.lower);
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    return 2.0 * std::tan(0.5 * std::clamp(angle - hinge.angle, 0.0, kMostFold));
}

double RodEnergy::hingeEnergy(const Vec3& r, const Vec3& axis, double fold) {
    const double about = r.dot(axis), back = std::min(about, 0.0), across2 = std::max(r.squaredNorm() - about * about, 0.0);
    return 0.5 * ((about < fold ? kFold : 1.0) * (about - fold) * (about - fold) + (kHinge - 1.0) * back * back + kHinge * across2);
}

double RodEnergy::heldStiffness() const { return kGoalForce * size_ / kBendSlack; }

RodEnergy::Tension RodEnergy::stop(const Bend& bend, double curvature) const {
    const double y = (curvature - bend.limit) / kBendSlack, torque = kGoalForce * size_;
    if (y <= 0.0) return {};
    return {torque * y * y, 2.0 * torque * y / kBendSlack, torque * kBendSlack * y * y * y / 3.0};
}

RodEnergy::Pull RodEnergy::pull(const Vec3& miss) const {
    const double reach = kGoalReach * unit_, far = kFarGoal * unit_;
    const double r = std::sqrt(miss.squaredNorm() + reach * reach);
    const double near = (1.0 - kFarPull) * far;
    return {kGoalForce * (kFarPull + near / (far + r)) / r, kGoalForce * (kFarPull * r + near * std::log1p(r / far))};
}

double RodEnergy::energy(const std::vector<Vec3>& points, const IkTargets& targets) const {
    double sum = 0.0;
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b)
        sum += stretch(b, along(static_cast<int>(b), points).norm()).energy;
    for (std::size_t i = 0; i < bends_.size(); ++i) {
        const auto& bend = bends_[i];
        const Vec3 p = directionOf(bend.parent, points, frames_[bend.parent]);
        const Vec3 d = directionOf(bend.child, points, frames_[bend.child]);
        const Vec3 t = minimalRotation(direction_[bend.parent], p) * bent_[i];
        const double c = t.dot(d);
        if (bend.hinge.is)
            sum += bend.stiffness * hingeEnergy(2.0 * t.cross(d) / std::max(1.0 + c, 1e-9), minimalRotation(direction_[bend.parent], p) * axis_[i], fold_[i]);
        else
            sum += 2.0 * bend.stiffness * (1.0 - c) / std::max(1.0 + c, 1e-12);
        if (bend.limited) sum += stop(bend, 2.0 * std::sqrt(std::max(1.0 - c, 0.0) / std::max(1.0 + c, 1e-9))).energy;
    }
    for (const auto& held : targets.directions) {
        const double c = held.direction.dot(directionOf(held.bone, points, frames_[held.bone]));
        sum += 2.0 * held.stiffness * (1.0 - c) / std::max(1.0 + c, 1e-12);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (targets.held[i]) sum += pull(points[i] - targets.place[i]).energy;
        sum -= side_[i].dot(points[i] - x_[i]);
    }
    return sum;
}

void RodEnergy::linearise(const std::vector<Vec3>& x, const std::vector<Quaterniond>& frames, const IkTargets& targets, double viscosity,
                       BlockCholesky<3>& system, std::vector<Vec3>& force) {
    x_ = x;
    frames_ = frames;
    system.setZero();
    const Matrix3d eye = Matrix3d::Identity();
    for (std::size_t i = 0; i < x.size(); ++i) {
        gradient_[i].setZero();
        side_[i].setZero();
        system.add(static_cast<int>(i), static_cast<int>(i), viscosity / unit_ * eye);
        if (!targets.held[i]) continue;
        const Vec3 miss = x[i] - targets.place[i];
        const double weight = pull(miss).perMetre;
        gradient_[i] += weight * miss;
        system.add(static_cast<int>(i), static_cast<int>(i), weight * eye);
    }
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        const double length = along(static_cast<int>(b), x).norm();
        const Vec3 d = direction_[b] = directionOf(static_cast<int>(b), x, frames[b]);
        const Tension r = stretch(b, length);
        const Matrix3d outer = d * d.transpose();
        // Under compression the transverse (geometric) stiffness is negative; it is left out so that the matrix stays positive definite.
        const Matrix3d h = r.slope * outer + std::max(r.force, 0.0) / std::max(length, 0.01 * bone.length) * (eye - outer);
        system.add(bone.start, bone.start, h);
        system.add(bone.end, bone.end, h);
        system.add(bone.start, bone.end, -h);
        gradient_[bone.start] -= r.force * d;
        gradient_[bone.end] += r.force * d;
        bend2_[b] = 0.0;
    }
    for (std::size_t i = 0; i < bends_.size(); ++i) {
        const auto& bend = bends_[i];
        const Vec3 p = direction_[bend.parent], d = direction_[bend.child];
        const Vec3 t = bent_[i] = frames[bend.parent] * tree_.restDirection[bend.child];
        const double parentLength = std::max(along(bend.parent, x).norm(), 0.01 * skeleton_.bones[bend.parent].length);
        const double childLength = std::max(along(bend.child, x).norm(), 0.01 * skeleton_.bones[bend.child].length);
        const double cosine = std::max(1.0 + t.dot(d), 1e-9);
        const Vec3 r = 2.0 * t.cross(d) / cosine;
        const Matrix3d byChild = (2.0 * cross(t) - r * t.transpose()) / cosine * (eye - d * d.transpose()) / childLength;
        const Matrix3d byParent = (2.0 * cross(d) + r * d.transpose()) / cosine * (cross(t) * cross(p)) / parentLength;
        bend2_[bend.parent] = std::max(bend2_[bend.parent], r.squaredNorm());
        bend2_[bend.child] = std::max(bend2_[bend.child], r.squaredNorm());
        Matrix3d jacobian[4];
        for (int k = 0; k < bend.count; ++k) jacobian[k] = bend.onParent[k] * byParent + bend.onChild[k] * byChild;
        if (bend.limited) addStop(bend, r, jacobian, system);
        if (bend.hinge.is) {
            addHinge(bend, i, r, p / parentLength, jacobian, system);
            continue;
        }
        for (int k = 0; k < bend.count; ++k) {
            gradient_[bend.point[k]].noalias() += bend.stiffness * jacobian[k].transpose() * r;
            for (int l = 0; l <= k; ++l)
                system.add(bend.point[k], bend.point[l], bend.stiffness * jacobian[k].transpose() * jacobian[l]);
        }
    }
    for (const auto& held : targets.directions) {
        const auto& bone = skeleton_.bones[held.bone];
        const Vec3& d = direction_[held.bone];
        const Vec3 t = besideOpposite(held.direction, d, frames[held.bone] * restSide_[held.bone]);
        const double cosine = std::max(1.0 + t.dot(d), 1e-9), length = std::max(along(held.bone, x).norm(), 0.01 * bone.length);
        const Vec3 r = 2.0 * t.cross(d) / cosine;
        const Matrix3d jacobian = (2.0 * cross(t) - r * t.transpose()) / cosine * (eye - d * d.transpose()) / length;
        const Vec3 slope = held.stiffness * (jacobian.transpose() * r);
        const Matrix3d h = held.stiffness * (jacobian.transpose() * jacobian);
        gradient_[bone.start] -= slope;
        gradient_[bone.end] += slope;
        system.add(bone.start, bone.start, h);
        system.add(bone.end, bone.end, h);
        system.add(bone.start, bone.end, -h);
    }
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        const auto& bone = skeleton_.bones[b];
        const double compressed = natural_[b] - along(static_cast<int>(b), x).norm() / bone.length;
        const double straight = 1.0 - bend2_[b] / (kStraight * kStraight);
        if (compressed <= 0.0 || straight <= 0.0) continue;
        const Vec3 push = kSideForce * compressed * straight * (frames[b] * restSide_[b]);
        side_[bone.start] += push;
        side_[bone.end] += push;
    }
    for (std::size_t i = 0; i < x.size(); ++i) force[i] = side_[i] - gradient_[i];
}

void RodEnergy::addHinge(const Bend& bend, std::size_t index, const Vec3& r, const Vec3& parent, const Matrix3d* jacobian, BlockCholesky<3>& system) {
    const Vec3& axis = axis_[index] = frames_[bend.parent] * skeleton_.bones[bend.child].hinge;
    const double fold = fold_[index] = folded(bend.hinge, (x_[bend.hinge.tip] - x_[bend.hinge.root]).norm());
    const double about = r.dot(axis);
    const double drive = about < fold ? kFold : 1.0, back = about < 0.0 ? kHinge - 1.0 : 0.0;
    const Vec3 torque = bend.stiffness * (kHinge * (r - about * axis) + (drive * (about - fold) + back * about) * axis);
    const Matrix3d h = bend.stiffness * (kHinge * Matrix3d::Identity() + (drive + back - kHinge) * axis * axis.transpose());
    const Vec3 carried = torque.cross(r).cross(parent);  // the axis turns with the parent
    for (int k = 0; k < bend.count; ++k) {
        gradient_[bend.point[k]].noalias() += jacobian[k].transpose() * torque + bend.onParent[k] * carried;
        for (int l = 0; l <= k; ++l) system.add(bend.point[k], bend.point[l], jacobian[k].transpose() * h * jacobian[l]);
    }
}

void RodEnergy::addStop(const Bend& bend, const Vec3& r, const Matrix3d* jacobian, BlockCholesky<3>& system) {
    const double curvature = r.norm();
    const Tension s = stop(bend, curvature);
    if (s.force <= 0.0) return;
    const Vec3 axis = r / curvature;
    const Matrix3d along = axis * axis.transpose();
    const Matrix3d h = s.slope * along + s.force / curvature * (Matrix3d::Identity() - along);
    for (int k = 0; k < bend.count; ++k) {
        gradient_[bend.point[k]].noalias() += s.force * (jacobian[k].transpose() * axis);
        for (int l = 0; l <= k; ++l) system.add(bend.point[k], bend.point[l], jacobian[k].transpose() * h * jacobian[l]);
    }
}

bool RodEnergy::turnsBeyond(double cosine, const std::vector<Vec3>& points) const {
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
        // The direction of a collapsed bone means nothing.
        if (along(static_cast<int>(b), x_).norm() < 1e-3 * skeleton_.bones[b].length) continue;
        if (direction_[b].dot(directionOf(static_cast<int>(b), points, frames_[b])) < cosine) return true;
    }
    return false;
}

}  // namespace imomushi
