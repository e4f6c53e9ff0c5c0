// SPDX-License-Identifier: GPL-3.0-or-later
// Joints whose pose is given, elements that move with them, turns of attached parts, and weights of morph targets.
#include <cmath>

#include "core/base/finite.h"
#include "core/base/rotation_vector.h"
#include "core/character/character_state.h"

namespace imomushi {

using Eigen::Quaterniond;

namespace {

/// A quaternion may be this far from a unit one before it counts as no rotation.
constexpr double kUnit = 1e-6;
/// m: farther places would overflow where they are squared.
constexpr double kFarthest = 1e100;

}  // namespace

void Character::State::buildHandles() {
    const auto& input = frame.input;
    std::vector<std::vector<RigidFit::Part>> parts(input.elements.size());
    for (std::size_t h = 0; h < input.handles.size(); ++h) {
        const auto j = static_cast<std::size_t>(input.handles[h].joint);
        const auto& f = input.joints[j].faces[0];
        const JointFace& face = input.elements[static_cast<std::size_t>(f.element)].faces[static_cast<std::size_t>(f.face)];
        frame.joints[j].handle = true;
        frame.handles.emplace_back().pose.at = frame.joints[j].restPlace;
        frame.elements[static_cast<std::size_t>(f.element)].handles.push_back(static_cast<int>(h));
        parts[static_cast<std::size_t>(f.element)].push_back({face.frame.origin, face.area, face.size});
    }
    for (std::size_t e = 0; e < parts.size(); ++e)
        if (input.elements[e].bones.empty() && !parts[e].empty()) frame.elements[e].fit = std::make_shared<RigidFit>(std::move(parts[e]));
}

void Character::State::placeHandle(std::size_t h) {
    const auto& given = frame.input.handles[h];
    const auto& joint = frame.input.joints[static_cast<std::size_t>(given.joint)];
    const auto e = static_cast<std::size_t>(joint.faces[0].element);
    const ElementState& element = frame.elements[e];
    HandleFrame& handle = frame.handles[h];
    if (given.bone >= 0) {
        // The end of a bone has its own roll, of which the bone has the mean.
        const auto& bone = frame.input.skeleton.bones[static_cast<std::size_t>(given.bone)];
        const auto point = static_cast<std::size_t>(given.atEnd ? bone.end : bone.start);
        const Quaterniond& q = frame.pose.frames[static_cast<std::size_t>(given.bone)];
        const double roll = frame.tree.rollSign[static_cast<std::size_t>(given.bone)] * frame.pose.roll[point];
        handle.carrierTurn = roll == 0.0 ? q : Quaterniond(Eigen::AngleAxisd(roll, q * frame.tree.restDirection[static_cast<std::size_t>(given.bone)])) * q;
        handle.carrier.linear = handle.carrierTurn.toRotationMatrix();
        handle.carrier.shift = frame.pose.points[point] - handle.carrier.linear * frame.input.skeleton.points[point];
    } else if (!frame.input.elements[e].bones.empty()) {
        handle.carrierTurn = element.rotation;
        handle.carrier = element.frame;
    }
    JointState& out = frame.joints[static_cast<std::size_t>(given.joint)];
    out.rotation = handle.pose.held ? handle.pose.rotation : (handle.carrierTurn * handle.pose.rotation).normalized();
    out.at = handle.pose.held ? handle.pose.at : handle.carrier(handle.pose.at);
    out.rotationMatrix = out.rotation.toRotationMatrix();
    out.stretch = 1.0;
}

void Character::State::fitElement(ElementState& element) const {
    if (element.fit) {
        for (std::size_t i = 0; i < element.handles.size(); ++i) {
            const auto& joint = frame.joints[static_cast<std::size_t>(frame.input.handles[static_cast<std::size_t>(element.handles[i])].joint)];
            element.fit->set(i, joint.at, joint.rotation);
        }
        element.fit->solve(element.rotation, element.frame.shift);
        element.frame.linear = element.rotation.toRotationMatrix();
    }
}

bool Character::setHandle(int handle, const HandlePose& pose) {
    if (!allFinite(pose.at) || !allFinite(pose.rotation.coeffs())) return false;
    if (pose.at.cwiseAbs().maxCoeff() > kFarthest || pose.rotation.coeffs().cwiseAbs().maxCoeff() > 2.0 || std::abs(pose.rotation.norm() - 1.0) > kUnit) return false;
    HandlePose& to = state_->frame.handles[static_cast<std::size_t>(handle)].pose;
    to = pose;
    to.rotation.normalize();
    return true;
}

bool Character::setTurn(int element, int part, const Quaterniond& turn) {
    if (!allFinite(turn.coeffs()) || turn.coeffs().cwiseAbs().maxCoeff() > 2.0 || std::abs(turn.norm() - 1.0) > kUnit) return false;
    Vec3& to = state_->frame.elements[static_cast<std::size_t>(element)].askedTurns[static_cast<std::size_t>(part)];
    const Vec3 asked = rotationVector(turn);
    if (to == asked) return false;
    to = asked;
    return true;
}

bool Character::setMorph(int mesh, int target, double weight) {
    if (!isFinite(weight) || std::abs(weight) > kLargestMorphWeight) return false;
    double& to = state_->frame.askedMorphs[static_cast<std::size_t>(mesh)][static_cast<std::size_t>(target)];
    if (to == weight) return false;
    to = weight;
    return true;
}

const HandlePose& Character::handlePose(int handle) const { return state_->frame.handles[static_cast<std::size_t>(handle)].pose; }

HandlePose Character::shownHandle(int handle) const {
    const auto& joint = state_->frame.joints[static_cast<std::size_t>(state_->frame.input.handles[static_cast<std::size_t>(handle)].joint)];
    return {joint.map(joint.restPlace), joint.rotation, true};
}

Eigen::Isometry3d Character::handleCarrier(int handle) const {
    const AffineMap& carrier = state_->frame.handles[static_cast<std::size_t>(handle)].carrier;
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = carrier.linear;
    out.translation() = carrier.shift;
    return out;
}

}  // namespace imomushi
