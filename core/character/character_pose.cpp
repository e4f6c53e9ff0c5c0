// SPDX-License-Identifier: GPL-3.0-or-later
// Pose -> rotation, place and in-plane stretch of every joint -> its map -> v of every element in its own moving frame. With smooth joints: of rigid ones,
// whose shapes follow in Stage::Equilibrium.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/character/character_state.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// Twist in radians or shift in face sizes that the basis cannot say and an artist would see.
constexpr double kVisibleLoss = 1e-3;
// In-plane stretches stay within these, approached smoothly.
constexpr double kMinStretch = 0.3, kMaxStretch = 3.0;

/// Weighted mean of rotations given as quaternions. Within one tree signs say which way a bend went round (Pose::frames); across trees they mean
/// nothing and are aligned with the first.
class MeanRotation {
public:
    void add(const Quaterniond& q, double weight, int tree) {
        double sign = 1.0;
        if (first_ == kNone)
            first_ = tree;
        else if (tree != first_ && sum_.dot(q.coeffs()) < 0.0)
            sign = -1.0;
        if (!last_) reference_ = q;
        last_ = true;
        sum_ += sign * weight * q.coeffs();
    }
    [[nodiscard]] Quaterniond get() const {
        const double n = sum_.norm();
        return n > 1e-6 ? Quaterniond(Eigen::Vector4d(sum_ / n)) : reference_;
    }

private:
    static constexpr int kNone = std::numeric_limits<int>::min();
    Eigen::Vector4d sum_ = Eigen::Vector4d::Zero();
    Quaterniond reference_ = Quaterniond::Identity();
    int first_ = kNone;
    bool last_ = false;
};

// 1 + x near 0, between the limits everywhere, twice differentiable.
double boundedStretch(double x) {
    const double room = x < 0.0 ? 1.0 - kMinStretch : kMaxStretch - 1.0;
    return 1.0 + room * std::tanh(x / room);
}

// The same to first order, as a free bar of Poisson ratio nu contracts when it is stretched by far: (length)^-nu.
double freeStretch(double x, double nu) {
    if (nu < 1e-3) return boundedStretch(x);
    return std::clamp(std::pow(std::max(1.0 - x / nu, 1e-3), -nu), kMinStretch, kMaxStretch);
}

}  // namespace

Quaterniond Character::State::rolled(int bone) const {
    const double roll = boneRoll(frame.input.skeleton, frame.tree, frame.pose, bone);
    const Quaterniond& q = frame.pose.frames[bone];
    if (roll == 0.0) return q;
    return Quaterniond(Eigen::AngleAxisd(roll, q * frame.tree.restDirection[bone])) * q;
}

void Character::State::placeElement(std::size_t e) {
    const auto& given = frame.input.elements[e];
    auto& out = frame.elements[e];
    if (given.bones.empty()) {
        if (out.fit) return;  // its handles place it
        out.rotation = Quaterniond::Identity();
        out.frame = {};
        return;
    }
    MeanRotation mean;
    Vec3 anchor = Vec3::Zero();
    for (const int b : given.bones) {
        const auto& bone = frame.input.skeleton.bones[b];
        mean.add(rolled(b), bone.length, frame.tree.tree[b]);
        anchor += 0.5 * bone.length * (frame.pose.points[bone.start] + frame.pose.points[bone.end]);
    }
    anchor /= out.boneLength;
    if (out.anchorJoint >= 0) anchor = frame.pose.points[frame.input.joints[out.anchorJoint].point];
    out.rotation = mean.get().normalized();
    out.frame.linear = out.rotation.toRotationMatrix();
    out.frame.shift = anchor - out.frame.linear * out.restAnchor;
}

void Character::State::placeJoint(std::size_t j) {
    const auto& given = frame.input.joints[j];
    const auto& pose = frame.pose;
    const auto& tree = frame.tree;
    auto& out = frame.joints[j];
    MeanRotation mean;
    Vec3 carried = Vec3::Zero();
    double outward = 0.0;
    int shifted = 0;
    for (const auto& f : given.faces) {
        const auto& element = frame.elements[f.element];
        carried += element.frame(out.restPlace) / static_cast<double>(given.faces.size());
        // A tree of its own for elements that no bone of the joint moves.
        const int alone = -1 - f.element;
        if (out.led) {
            if (frame.input.elements[f.element].leadsJointPlanes) mean.add(element.rotation, 1.0, f.bone >= 0 ? tree.tree[f.bone] : alone);
        } else if (f.bone >= 0 && given.point >= 0) {
            mean.add(pose.frames[f.bone], 1.0, tree.tree[f.bone]);
        } else {
            mean.add(element.rotation, 1.0, alone);
        }
    }
    out.at = given.point >= 0 ? pose.points[given.point] : carried;
    for (const auto& f : given.faces) {
        if (f.bone < 0) continue;
        const auto& element = frame.elements[f.element];
        const Vec3 normal = frame.input.elements[f.element].faces[f.face].frame.axes.col(2);
        outward += (element.frame.linear * normal).dot(out.at - element.frame(out.restPlace));
        ++shifted;
    }
    Quaterniond rotation = mean.get();
    if (!out.led && given.point >= 0 && pose.roll[given.point] != 0.0 && out.restTangent != Vec3::Zero())
        rotation = Quaterniond(Eigen::AngleAxisd(pose.roll[given.point], rotation * out.restTangent)) * rotation;
    out.rotation = rotation.normalized();
    out.rotationMatrix = out.rotation.toRotationMatrix();
    out.stretch = 1.0;
    out.pull = shifted && !frame.smooth ? out.contraction * outward / shifted : 0.0;
    if (out.pull != 0.0) out.stretch = out.warped && !out.fades ? freeStretch(out.pull, out.nu) : boundedStretch(out.pull);
}

void Character::State::mapJoint(JointState& joint) const {
    if (frame.smooth || joint.handle) {
        joint.map.linear = joint.rotationMatrix;
    } else {
        const Vec3& n = joint.restNormal;
        const Matrix3d across = n * n.transpose();
        joint.map.linear = joint.rotationMatrix * (across + joint.stretch * (Matrix3d::Identity() - across));
    }
    joint.map.shift = joint.at - joint.map.linear * joint.restPlace;
}

void Character::State::findParameters(std::size_t e) {
    const auto& given = frame.input.elements[e];
    auto& out = frame.elements[e];
    if (!given.response) return;
    for (std::size_t f = 0; f < given.faces.size(); ++f) {
        const auto& face = given.faces[f];
        const AffineMap& joint = frame.joints[out.jointOf[f]].map;
        JointMap local;
        local.linear = face.frame.axes.transpose() * (out.frame.linear.transpose() * joint.linear) * face.frame.axes;
        local.shift = face.frame.axes.transpose() *
                      (out.frame.linear.transpose() * (joint(face.frame.origin) - out.frame(face.frame.origin)));
        double lost = 0.0;
        given.response->bases[f].coefficients(local, out.runtime->restOfFace[f], face.size, out.v.data() + given.response->firstColumn[f], lost);
        if (lost > kVisibleLoss) frame.warn(FrameWarning::BasisLosesTwist);
    }
}

void Character::State::weighEffects() {
    for (auto& joint : frame.joints)
        if (joint.fades) joint.warpPart = 0.0;
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        auto& out = frame.elements[e];
        if (!out.fades) continue;
        findMotions(out);
        out.warpPart = 0.0;
        if (out.runtime->watch->isCalm(out.watched)) continue;
        if (PoseWatch::isBent(out.watched)) {
            out.warpPart = 1.0;
        } else {
            findParameters(e);
            out.warpPart = PoseWatch::callForWarp(out.runtime->watch->measure(out.v, out.watched, out.watchRoom));
        }
        for (const int j : jointsOf[e]) {
            auto& part = frame.joints[static_cast<std::size_t>(j)].warpPart;
            part = std::max(part, out.warpPart);
        }
    }
    for (auto& joint : frame.joints) {
        if (!joint.fades || joint.warpPart == 0.0 || joint.pull == 0.0) continue;
        joint.stretch += joint.warpPart * (freeStretch(joint.pull, joint.nu) - joint.stretch);
        mapJoint(joint);
    }
}

void Character::State::findMotions(ElementState& element) const {
    const Matrix3d toElement = element.frame.linear.transpose();
    for (std::size_t f = 0; f < element.watched.size(); ++f) {
        const auto& joint = frame.joints[static_cast<std::size_t>(element.jointOf[f])];
        element.watched[f] = {toElement * joint.map.linear, toElement * (joint.map.shift - element.frame.shift), element.rotation.conjugate() * joint.rotation};
    }
}

}  // namespace imomushi
