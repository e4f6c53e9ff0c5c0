// SPDX-License-Identifier: GPL-3.0-or-later
// The gizmo of the pose tool, and what moves with what it drags.
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "ui/models/paths.h"
#include "ui/tools/picking.h"
#include "ui/tools/pose_tool.h"

namespace imomushi {

Eigen::Matrix3d PoseTool::axesOf(const PoseGrip& grip) const {
    const Session& session = document_.session();
    if (grip.isHandle()) {
        const auto pose = session.poseOf(grip.handle);
        return pose ? pose->rotation.toRotationMatrix() : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    }
    return axesOfBone(session, grip.end.bone);
}

std::optional<GizmoPlace> PoseTool::gizmo() const {
    if (!gizmo_ || !options_.gizmo || busy()) return std::nullopt;
    const auto grip = selectedGrip();
    const auto at = grip ? gripPosition(document_.session(), *grip) : std::nullopt;
    return at ? std::optional(GizmoPlace{*at, axesOf(*grip), grip->isHandle(), false}) : std::nullopt;
}

render::GizmoPart PoseTool::gizmoPart(const PointerEvent& e) const {
    const auto place = gizmo();
    if (!place || (e.modifiers & Qt::ShiftModifier) || !e.bonesVisible) return render::GizmoPart::None;
    // An end of a bone there is taken as it is without the gizmo, also one behind another.
    return pickEndpoint(document_.session(), e) ? render::GizmoPart::None : gizmoUnder(e, *place, options_.space);
}

void PoseTool::pull(render::GizmoPart part, const PointerEvent& e) {
    const auto grip = selectedGrip();
    const auto at = grip ? gripPosition(document_.session(), *grip) : std::nullopt;
    if (!at) return;
    take(*grip, *at, e);
    hoveredPart_ = part;
    drag_->ring = turnsBy(part);
    lockTo(drag_->lock, part);
    drag_->normal = drag_->lock.plane(e);
    if (drag_->normal.norm() > 0.5) drag_->grip = e.onPlane(*at, drag_->normal, *at);
}

// As a ring is turned: the pointer goes about the middle.
void PoseTool::turnAround(const PointerEvent& e) {
    Drag& drag = *drag_;
    const auto middle = e.onScreen(drag.origin);
    if (!middle) return;
    const Eigen::Vector2d from = Eigen::Vector2d(drag.lastX, drag.lastY) - *middle, to = Eigen::Vector2d(e.x, e.y) - *middle;
    constexpr double kLeastArm = 4.0;  // pixels of the design
    if (from.norm() < kLeastArm || to.norm() < kLeastArm) return;
    const double by = std::atan2(from.y() * to.x() - from.x() * to.y(), from.dot(to));
    const Vec3 axis = turningAxis();
    drag.rotation = (Eigen::AngleAxisd(e.pace() * (axis.dot(e.viewForward) > 0.0 ? -by : by), axis) * drag.rotation).normalized();
}

Snap::Moving PoseTool::moving() const {
    const Session& session = document_.session();
    const Document& d = document_.document();
    // Bones that share a joint point, or run through one element, hang together; elements that are joined, or pieces of one character, too.
    auto bones = std::make_shared<std::set<PartId>>();
    auto elements = std::make_shared<std::set<PartId>>();
    const auto together = [&](PartId a, PartId b) {
        const auto of = d.elements.find(a), other = d.elements.find(b);
        return of != d.elements.end() && other != d.elements.end() && of->second->piece && other->second->piece && of->second->piece->character == other->second->piece->character;
    };
    if (drag_->end.isHandle()) elements->insert(drag_->end.handle.element);
    else bones->insert(drag_->end.end.bone);
    for (bool grows = true; grows;) {
        const std::size_t before = bones->size() + elements->size();
        std::set<int> points;
        for (const auto& [id, bone] : d.bones) {
            if (!bones->contains(id)) continue;
            points.insert({session.pointIndex({id, false}), session.pointIndex({id, true})});
            if (bone->element) elements->insert(bone->element);
        }
        points.erase(-1);
        for (const auto& [id, bone] : d.bones)
            if (points.contains(session.pointIndex({id, false})) || points.contains(session.pointIndex({id, true})) || elements->contains(bone->element)) bones->insert(id);
        for (const auto& [id, joint] : d.joints) {
            const bool any = std::any_of(joint->faces.begin(), joint->faces.end(), [&](const FaceRef& face) { return elements->contains(face.element); });
            if (any)
                for (const FaceRef& face : joint->faces) elements->insert(face.element);
        }
        for (const auto& [id, element] : d.elements)
            if (std::any_of(elements->begin(), elements->end(), [&, one = id](PartId other) { return together(one, other); })) elements->insert(id);
        grows = bones->size() + elements->size() > before;
    }
    return {[this, bones](const EndpointRef& end) { return bones->contains(end.bone) && !isPinned(document_.document(), {end, {}}); }, [elements](PartId element) { return elements->contains(element); }};
}

}  // namespace imomushi
