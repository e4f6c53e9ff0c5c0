// SPDX-License-Identifier: GPL-3.0-or-later
// The gizmo of the pose tool, and what moves with what it drags.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "core/base/union_find.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
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
    return at ? std::optional(withParts({*at, axesOf(*grip), grip->isHandle(), false}, options_.parts)) : std::nullopt;
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
    std::map<PartId, int> places;  // of bones, elements and characters: no two parts have one id
    for (const auto& [id, bone] : d.bones) places.emplace(id, int(places.size()));
    for (const auto& [id, element] : d.elements) places.emplace(id, int(places.size()));
    for (const auto& [id, character] : d.characters) places.emplace(id, int(places.size()));
    const auto points = session.plan().input.skeleton.points.size();
    UnionFind sets(places.size() + points);
    const auto unite = [&](PartId a, PartId b) {
        const auto one = places.find(a), other = places.find(b);
        if (one != places.end() && other != places.end()) sets.unite(one->second, other->second);
    };
    for (const auto& [id, bone] : d.bones) {
        for (const bool atEnd : {false, true})
            if (const int point = session.pointIndex({id, atEnd}); point >= 0 && std::size_t(point) < points) sets.unite(places.at(id), int(places.size()) + point);
        if (bone->element) unite(id, bone->element);
    }
    for (const auto& [id, joint] : d.joints)
        for (const FaceRef& face : joint->faces) unite(joint->faces.front().element, face.element);
    for (const auto& [id, element] : d.elements)
        if (element->piece) unite(id, element->piece->character);
    auto bones = std::make_shared<std::set<PartId>>();
    auto elements = std::make_shared<std::set<PartId>>();
    const auto own = places.find(drag_->end.isHandle() ? drag_->end.handle.element : drag_->end.end.bone);
    if (own != places.end())
        for (const auto& [id, place] : places) {
            if (sets.find(place) != sets.find(own->second)) continue;
            if (d.bones.contains(id)) bones->insert(id);
            if (d.elements.contains(id)) elements->insert(id);
        }
    return {[this, bones](const EndpointRef& end) { return bones->contains(end.bone) && !isPinned(document_.document(), {end, {}}); }, [elements](PartId element) { return elements->contains(element); }};
}

}  // namespace imomushi
