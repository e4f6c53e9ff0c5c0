// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/part_drag.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/decompositions.h"
#include "core/base/finite.h"
#include "core/base/rotation_vector.h"
#include "core/document/attachments.h"
#include "core/document/character_input.h"
#include "ui/models/commands.h"
#include "ui/picking/picking.h"
#include "ui/scene/seen_mesh.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

constexpr double kTurnPerNotch = 5.0 * std::numbers::pi / 180.0;
/// A part is held this far from its pivot at least, logical pixels: nearer it would spin.
constexpr double kLeastArm = 16.0;

/// The rigid motion of a part from rest to where it is seen.
Eigen::Matrix4d motionOf(const SeenMesh& seen, const std::vector<std::int32_t>& vertices) {
    Eigen::Matrix3Xd rest(3, Eigen::Index(vertices.size())), now(3, Eigen::Index(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        rest.col(Eigen::Index(i)) = seen.model().mesh.body.vertices.row(vertices[i]).transpose();
        now.col(Eigen::Index(i)) = seen.at(vertices[i]);
    }
    return nearestMotion(rest, now);
}

}  // namespace

std::optional<PartDrag::Grip> PartDrag::grip(const PointerEvent& e) const {
    const Session& session = document_.session();
    if (document_.document().characters.empty()) return std::nullopt;
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    if (hits.empty() || hits.front().character == 0) return std::nullopt;
    const RayHit& hit = hits.front();
    for (const SeenMesh& seen : seenMeshes(session)) {
        const CharacterSource& character = *seen.source;
        if (character.id != hit.character) continue;
        const std::int32_t vertex = seen.model().mesh.body.triangles(hit.seen, 0);
        for (const CharacterPlan::Rigid& rigid : session.plan().rigid) {
            if (rigid.part.character != character.id || !isRigid(character, rigid.part.part)) continue;
            const auto vertices = attachedVertices(character, rigid.part.part);
            if (!std::binary_search(vertices.begin(), vertices.end(), vertex)) continue;
            const Eigen::Matrix4d motion = motionOf(seen, vertices);
            Grip grip;
            grip.part = rigid.part;
            grip.pivot = (motion * pivotOf(character, rigid.part.part).homogeneous()).head<3>();
            grip.at = e.rayOrigin + hit.distance * e.rayDirection;
            if (const auto turned = document_.document().turns.find(rigid.part); turned != document_.document().turns.end()) grip.rotation = turned->second.now();
            grip.carrier = (Eigen::Quaterniond(Eigen::Matrix3d(motion.topLeftCorner<3, 3>())) * grip.rotation.conjugate()).normalized();
            return grip;
        }
    }
    return std::nullopt;
}

bool PartDrag::hover(const PointerEvent& e) {
    over_ = grip(e);
    return over_.has_value();
}

bool PartDrag::press(const PointerEvent& e) {
    if (drag_ || e.button != Qt::LeftButton) return false;
    const auto taken = grip(e);
    if (!taken) return false;
    over_.reset();
    drag_ = Drag{*taken, nullptr, taken->at, e.x, e.y, e.viewForward};
    return true;
}

void PartDrag::turn(const Eigen::Quaterniond& by) {
    Grip& grip = drag_->grip;
    grip.rotation = (grip.carrier.conjugate() * by * grip.carrier * grip.rotation).normalized();
    grip.at = grip.pivot + by * (grip.at - grip.pivot);
    const auto character = document_.document().characters.find(grip.part.character);
    if (!allFinite(grip.rotation.coeffs()) || character == document_.document().characters.end()) return cancel();
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    if (!document_.execute(commands::turnPart(character->second->name, character->second->model->namedParts().nameOf(grip.part.part), grip.rotation))) cancel();
}

void PartDrag::move(const PointerEvent& e) {
    if (!drag_ || (!drag_->gesture && std::hypot(e.x - drag_->pressX, e.y - drag_->pressY) < kDragPixels)) return;
    const Grip& grip = drag_->grip;
    const Vec3 under = e.onPlane(drag_->held, e.viewForward, drag_->held);
    const Vec3 step = e.pace() * (under - drag_->held);
    drag_->held = under;
    if (drag_->typed.leads()) return;
    // About the axis across the line of sight and the way of the pointer, so that what is in front goes along.
    const double arm = std::max((grip.at - grip.pivot).norm(), kLeastArm * e.pixelAt(grip.pivot));
    turn(rotationOf((-e.viewForward).cross(step) / arm));
}

void PartDrag::release(const PointerEvent& e) {
    if (!drag_ || e.button != Qt::LeftButton) return;
    if (drag_->gesture) drag_->gesture->commit();
    drag_.reset();
}

bool PartDrag::wheel(double notches, const PointerEvent& e) {
    if (!drag_) return false;
    const double by = e.pace() * kTurnPerNotch * notches;
    if (drag_->typed.leads()) return true;
    drag_->seen += by;
    turn(rotationOf(-by * drag_->sight));
    return true;
}

bool PartDrag::key(int key, const QString& text) {
    if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        if (drag_->gesture) drag_->gesture->commit();
        drag_.reset();
    } else if (drag_->typed.key(key, text, TypedNumber::Of::Angle, {})) {
        const double before = drag_->typedNow, seen = drag_->seen;
        drag_->typedNow = drag_->typed.value(seen) - seen;
        turn(rotationOf(-(drag_->typedNow - before) * drag_->sight));
    }
    return true;
}

QString PartDrag::hint() const {
    if (drag_) return ToolTexts::tr("Turns about its pivot · Shift: fine · Wheel: about the line of sight · Esc: cancel");
    if (!over_) return {};
    const auto character = document_.document().characters.find(over_->part.character);
    if (character == document_.document().characters.end()) return {};
    return ToolTexts::tr("Drag: turn %1").arg(QString::fromStdString(character->second->model->namedParts().nameOf(over_->part.part)));
}

void PartDrag::decorate(render::Scene& scene) const {
    if (!drag_ && !over_) return;
    render::Marker pivot;
    pivot.shape = drag_ ? render::Marker::Shape::HeldPoint : render::Marker::Shape::JointPoint;
    pivot.from = pivot.to = drag_ ? drag_->grip.pivot : over_->pivot;
    pivot.hovered = true;
    scene.markers.push_back(std::move(pivot));
}

}  // namespace imomushi
