// SPDX-License-Identifier: GPL-3.0-or-later
// Pose -> rotation, place and in-plane stretch of every joint -> v of every element in its own moving frame. With smooth joints: rotation and place ->
// v of rigid joints -> shapes of all joints in equilibrium, and v with them.
#include "core/character/character_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/character/load_bound.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// Twist in radians or shift in face sizes that the basis cannot say and an artist would see.
constexpr double kVisibleLoss = 1e-3;
// Radians between an element and its joint at which the shapes of smooth joints have gone, where elements are warped.
constexpr double kFadedAngle = 0.6;
// In-plane stretches stay within these, approached smoothly.
constexpr double kLeastStretch = 0.3, kMostStretch = 3.0;

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
    const double room = x < 0.0 ? 1.0 - kLeastStretch : kMostStretch - 1.0;
    return 1.0 + room * std::tanh(x / room);
}

// The same to first order, as a free bar of Poisson ratio nu contracts when it is stretched by far: (length)^-nu.
double freeStretch(double x, double nu) {
    if (nu < 1e-3) return boundedStretch(x);
    return std::clamp(std::pow(std::max(1.0 - x / nu, 1e-3), -nu), kLeastStretch, kMostStretch);
}

}  // namespace

void Character::State::stepExplicitJoints() {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t j = 0; j < joints.size(); ++j) explicitJoints->setJoint(static_cast<int>(j), joints[j].turn.toRotationMatrix());
    for (std::size_t e = 0; e < elements.size(); ++e) explicitJoints->setElement(static_cast<int>(e), elements[e].frame.linear, elements[e].v);
    if (stopped) explicitJoints->reset();
    if (frameSeconds > 0.0 && !explicitJoints->step(frameSeconds))
        updateWarnings |= static_cast<unsigned>(FrameWarning::Diverged);
    for (std::size_t e = 0; e < elements.size(); ++e) explicitJoints->addTo(static_cast<int>(e), elements[e].v);
    stats.previousModelMs = milliseconds(start, std::chrono::steady_clock::now());
}

Quaterniond Character::State::rolled(int bone) const {
    const double roll = boneRoll(input.skeleton, tree, pose, bone);
    const Quaterniond& q = pose.frames[bone];
    if (roll == 0.0) return q;
    return Quaterniond(Eigen::AngleAxisd(roll, q * tree.restDirection[bone])) * q;
}

void Character::State::placeElement(std::size_t e) {
    const auto& given = input.elements[e];
    auto& out = elements[e];
    if (given.bones.empty()) return;
    MeanRotation mean;
    Vec3 anchor = Vec3::Zero();
    for (const int b : given.bones) {
        const auto& bone = input.skeleton.bones[b];
        mean.add(rolled(b), bone.length, tree.tree[b]);
        anchor += 0.5 * bone.length * (pose.points[bone.start] + pose.points[bone.end]);
    }
    anchor /= out.boneLength;
    if (out.anchorJoint >= 0) anchor = pose.points[input.joints[out.anchorJoint].point];
    out.rotation = mean.get().normalized();
    out.frame.linear = out.rotation.toRotationMatrix();
    out.frame.shift = anchor - out.frame.linear * out.restAnchor;
}

void Character::State::placeJoint(std::size_t j) {
    const auto& given = input.joints[j];
    auto& out = joints[j];
    MeanRotation mean;
    Vec3 carried = Vec3::Zero();
    double outward = 0.0;
    int shifted = 0;
    for (const auto& f : given.faces) {
        const auto& element = elements[f.element];
        carried += element.frame(out.restPlace) / static_cast<double>(given.faces.size());
        // A tree of its own for elements that no bone of the joint moves.
        const int alone = -1 - f.element;
        if (out.led) {
            if (input.elements[f.element].leadsJointPlanes) mean.add(element.rotation, 1.0, f.bone >= 0 ? tree.tree[f.bone] : alone);
        } else if (f.bone >= 0 && given.point >= 0) {
            mean.add(pose.frames[f.bone], 1.0, tree.tree[f.bone]);
        } else {
            mean.add(element.rotation, 1.0, alone);
        }
    }
    Vec3 at = given.point >= 0 ? pose.points[given.point] : carried;
    for (const auto& f : given.faces) {
        if (f.bone < 0) continue;
        const auto& element = elements[f.element];
        const Vec3 normal = input.elements[f.element].faces[f.face].frame.axes.col(2);
        outward += (element.frame.linear * normal).dot(at - element.frame(out.restPlace));
        ++shifted;
    }
    Quaterniond rotation = mean.get();
    if (!out.led && given.point >= 0 && pose.roll[given.point] != 0.0 && out.restTangent != Vec3::Zero())
        rotation = Quaterniond(Eigen::AngleAxisd(pose.roll[given.point], rotation * out.restTangent)) * rotation;
    out.turn = rotation.normalized();
    double stretch = 1.0;
    if (shifted && !equilibrium)
        stretch = out.warped ? freeStretch(out.shrink * outward / shifted, out.nu) : boundedStretch(out.shrink * outward / shifted);
    Matrix3d turned = out.turn.toRotationMatrix(), swollen = Matrix3d::Identity();
    if (out.jiggle) {
        JointJiggle::Place place{turned, at, stretch};
        if (stopped) out.jiggle->reset(place);
        out.jiggle->step(frameSeconds, place, swollen);
        if (!(place.rotation == turned)) {
            const Quaterniond jiggled(place.rotation);
            out.turn = jiggled.dot(out.turn) < 0.0 ? Quaterniond(-jiggled.coeffs()) : jiggled;
        }
        turned = place.rotation;
        at = place.at;
    }
    if (equilibrium) {
        out.rotation = out.map.linear = turned;
        out.map.shift = at - out.map.linear * out.restPlace;
        return;
    }
    const Vec3& n = out.restNormal;
    const Matrix3d across = n * n.transpose();
    out.map.linear = turned * (across + stretch * (Matrix3d::Identity() - across));
    if (out.jiggle) out.map.linear = out.map.linear * swollen;
    out.map.shift = at - out.map.linear * out.restPlace;
}

void Character::State::measure(std::size_t e) {
    const auto& given = input.elements[e];
    auto& out = elements[e];
    if (!given.response) return;
    for (std::size_t f = 0; f < given.faces.size(); ++f) {
        const auto& face = given.faces[f];
        const AffineMap& joint = joints[out.jointOf[f]].map;
        JointMap local;
        local.linear = face.frame.axes.transpose() * (out.frame.linear.transpose() * joint.linear) * face.frame.axes;
        local.shift = face.frame.axes.transpose() *
                      (out.frame.linear.transpose() * (joint(face.frame.origin) - out.frame(face.frame.origin)));
        double lost = 0.0;
        given.response->bases[f].coefficients(local, out.restOfFace[f], face.size, out.v.data() + given.response->firstColumn[f], lost);
        if (lost > kVisibleLoss) updateWarnings |= static_cast<unsigned>(FrameWarning::BasisLosesTwist);
    }
}

double Character::State::shownPart(std::size_t j) const {
    double angle = 0.0;
    for (const auto& f : input.joints[j].faces)
        angle = std::max(angle, joints[j].turn.angularDistance(elements[static_cast<std::size_t>(f.element)].rotation));
    const double part = 1.0 - std::min(1.0, angle * angle / (kFadedAngle * kFadedAngle));
    return part * part;
}

std::span<const double> Character::State::forcesOn(const ElementState& e) {
    if (!e.loads) return {};
    return {e.loads->forces.data(), static_cast<std::size_t>(e.loads->forces.size())};
}

void Character::State::relax() {
    for (std::size_t j = 0; j < joints.size(); ++j) equilibrium->setJoint(static_cast<int>(j), joints[j].rotation);
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (input.elements[e].response)
            equilibrium->setElement(static_cast<int>(e), elements[e].frame.linear, elements[e].v, forcesOn(elements[e]));
    equilibrium->solve();
    for (std::size_t j = 0; j < joints.size(); ++j) {
        auto& out = joints[j];
        const Vec3 at = out.map(out.restPlace);
        out.part = out.warped ? shownPart(j) : 1.0;
        Matrix3d stretch = equilibrium->stretch(static_cast<int>(j));
        if (out.warped) stretch = (Matrix3d::Identity() + out.part * (stretch - Matrix3d::Identity())).eval();
        out.map.linear = out.rotation * stretch;
        out.map.shift = at - out.map.linear * out.restPlace;
        out.warping.noalias() = out.rotation * equilibrium->warping(static_cast<int>(j));
        if (out.warped) out.warping *= out.part;
    }
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (elements[e].v.size() > 0) elements[e].v = equilibrium->parameters(static_cast<int>(e));
}

void Character::State::load(std::size_t e, double seconds) {
    auto& out = elements[e];
    if (!out.loads) return;
    auto& loads = *out.loads;
    const auto& given = input.elements[e];
    const Eigen::Index first = loads.first(), count = loads.all.size() - first;
    if (loads.gravity) {
        const Vec3 place = out.frame(out.middle);
        if (stopped) loads.felt.reset(place);
        loads.felt.step(seconds, place);
        const auto& gravity = *effects.gravity;
        const double softness = given.density / (gravity.shearModulus * given.stiffness);
        loads.all.segment<3>(first) = softness * (out.frame.linear.transpose() * (gravity.acceleration - gravity.inertia * loads.felt.value()));
    }
    if (loads.inflated) {
        const auto& inflate = *effects.inflate;
        loads.all[first + count - 1] = (inflate.pressure + inflate.breath * std::sin(breath)) / given.stiffness;
    }
    const double wanted = loads.all.tail(count).cwiseAbs().dot(out.columnSize.tail(count)), most = kMostLoaded * out.size;
    if (wanted <= 0.0) return;
    loads.all.tail(count) *= most * std::tanh(wanted / most) / wanted;
    if (wanted > most) updateWarnings |= static_cast<unsigned>(FrameWarning::LoadsBounded);
    if (!equilibrium) return;
    loads.forces.setZero();
    if (loads.gravity) loads.forces.noalias() += given.response->loadForces.leftCols<3>() * loads.all.segment<3>(first);
    if (loads.inflated) loads.forces.noalias() += given.response->loadForces.col(3) * loads.all[first + count - 1];
}

bool Character::State::resting() const {
    if (effects.inflate && effects.inflate->breath > 0.0 && effects.inflate->breathHertz > 0.0)
        for (const auto& e : elements)
            if (e.loads && e.loads->inflated) return false;
    for (const auto& e : elements) {
        if (e.loads && e.loads->gravity && !e.loads->felt.resting()) return false;
        if (e.touched && e.touched->active()) return false;
    }
    for (const auto& j : joints)
        if (j.jiggle && !j.jiggle->resting()) return false;
    if (explicitJoints && !explicitJoints->resting()) return false;
    return true;
}

}  // namespace imomushi
