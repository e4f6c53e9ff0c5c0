// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/body_drag.h"

#include <algorithm>

#include "core/base/finite.h"
#include "core/base/hash.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
#include "ui/scene/document_scene.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {

const BodyDrag::Parts& BodyDrag::parts() const {
    const Document& d = document_.document();
    if (parts_.selection == document_.selection() && parts_.elements == d.elements && parts_.bones == d.bones && parts_.joints == d.joints) return parts_;
    parts_ = {document_.selection(), d.elements, d.bones, d.joints, {}, {}, Vec3::Zero()};
    std::set<PartId> wanted;
    for (const SelectionItem& item : parts_.selection) {
        if (item.kind == SelectionItem::Kind::Element && d.elements.contains(item.part))
            parts_.names.push_back(d.elements.at(item.part)->name);
        else if (const CharacterSource* character = item.kind == SelectionItem::Kind::Character ? characterOf(d, item) : nullptr)
            parts_.names.push_back(character->name);
        else
            return parts_.names.clear(), parts_;
        wanted.insert(item.part);
    }
    parts_.hanging = hangingTogether(d, wanted);
    parts_.middle = middleOf(d, parts_.hanging);
    if (std::any_of(parts_.hanging.elements.begin(), parts_.hanging.elements.end(), [&](PartId id) { return d.elements.at(id)->locked; })) parts_.names.clear();
    return parts_;
}

std::optional<GizmoPlace> BodyDrag::gizmo() const {
    if (!shown_ || busy() || !keeps_.expired() || !chosen()) return std::nullopt;
    return withParts({parts().middle, Eigen::Matrix3d::Identity(), true, true}, gizmoParts_);
}

render::GizmoPart BodyDrag::gizmoPart(const PointerEvent& e) const {
    const auto place = gizmo();
    if (!place || (e.modifiers & (Qt::ShiftModifier | Qt::ControlModifier)) || pickGrip(document_.session(), e)) return render::GizmoPart::None;
    return gizmoUnder(e, *place, space_);
}

bool BodyDrag::take(Does does, const PointerEvent& e, bool modal) {
    if (!keeps_.expired() || !chosen()) return false;
    TransformDrag::Of of;
    of.pivot = parts().middle;
    of.axes = gizmoAxes(space_, of.axes, e.viewForward, e.viewRight);
    of.modal = modal;
    of.uniform = true;
    drag_.emplace(does, of, e);
    const auto hanging = std::make_shared<HangingParts>(parts().hanging);
    snap_.begin({[hanging](const EndpointRef& end) { return hanging->bones.contains(end.bone); }, [hanging](PartId element) { return hanging->elements.contains(element); }});
    return true;
}

bool BodyDrag::press(render::GizmoPart part, const PointerEvent& e) {
    if (!take(TransformDrag::doneBy(part), e, false)) return false;
    hovered_ = render::GizmoPart::None;
    drag_->lockTo(part, snap_);
    return true;
}

bool BodyDrag::begin(Does does, const PointerEvent& e) {
    if (!take(does, e, true)) return false;
    drag_->choose(does, snap_);
    return true;
}

bool BodyDrag::keep() {
    const TransformDrag by = *drag_;
    drag_.reset();
    moved_.clear();
    if (!by.moved()) return false;
    const Vec3 shift = by.shift();
    const Eigen::Quaterniond rotation = by.rotation();
    if (!allFinite(shift) || !allFinite(rotation.coeffs())) return true;
    // What did not go anywhere makes no step.
    if (shift.norm() == 0.0 && rotation.vec().norm() == 0.0 && by.factor() == 1.0) return true;
    const auto kept = std::make_shared<const Kept>(Kept{by, parts().hanging});
    keeps_ = kept;
    SlowStep step;
    step.command = commands::transform(parts().names, shift, rotation, by.factor(), by.pivot());
    step.done = [kept](const Json&) {};
    document_.executeSlow(std::move(step));
    return true;
}

bool BodyDrag::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    if (key == Qt::Key_Return || key == Qt::Key_Enter)
        keep();
    else
        (void)drag_->key(key, modifiers, text, snap_);
    return true;
}

int BodyDrag::results() const {
    const auto& elements = parts().hanging.elements;
    return int(std::count_if(elements.begin(), elements.end(), [&](PartId id) { return document_.session().responseState(id) == ResponseState::Fresh; }));
}

bool BodyDrag::recorded() const {
    const auto& moved = parts().hanging.elements;
    const auto& takes = document_.document().takes;
    return std::any_of(takes.begin(), takes.end(), [&](const auto& take) {
        const auto& elements = take.second->elements;
        return std::any_of(elements.begin(), elements.end(), [&](PartId id) { return moved.contains(id); });
    });
}

QString BodyDrag::banner() const {
    if (!drag_) return {};
    QStringList said(drag_->banner());
    said.removeAll(QString());
    if (drag_->does() == Does::Scales && results() > 0) said << ToolTexts::tr("What is scaled must be precomputed again");
    if (drag_->does() != Does::Moves && recorded()) said << ToolTexts::tr("Its takes will show their poses alone");
    return said.join(QStringLiteral(" · "));
}

QString BodyDrag::hint() const {
    if (!drag_) {
        if (hovered_ == render::GizmoPart::None) return {};
        if (!render::isOneOf(hovered_, render::GizmoPart::ScaleX)) return gizmoHint(hovered_);
        return ToolTexts::tr("Drag: scale · Type a number · Shift: fine · Ctrl: snap · Esc: cancel");
    }
    const QString keys = snap_.before(drag_->modal() ? ToolTexts::tr("Click or Enter: keep · G, R, S: move, turn, scale · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel")
                                                     : ToolTexts::tr("Release: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel"));
    if (drag_->does() == Does::Scales || results() == 0) return keys;
    return ToolTexts::tr("Results go along") + QStringLiteral(" · ") + keys;
}

void BodyDrag::carry(render::Body& body, Moved& moved, const Eigen::Affine3f& by) const {
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const auto rows = body.mesh->body.vertices.rows();
    const float *positions = body.positions, *normals = body.normals;
    std::vector<float> gathered[2];
    if (!positions && body.deformSurface >= 0) {  // the graphics card would make them
        Character* character = document_.session().character();
        if (!character) return;
        const int elements = int(character->input().elements.size());
        const Character::Surface surface = body.deformSurface < elements ? character->surface(body.deformSurface) : character->renderSurface(body.deformSurface - elements);
        positions = surface.positions, normals = surface.normals;
        if (body.deformSurface >= elements && body.modelVertices)
            for (int k = 0; k < 2; ++k) {
                for (const std::int32_t v : *body.modelVertices)
                    for (int i = 0; i < 3; ++i) gathered[k].push_back((k ? surface.normals : surface.positions)[3 * v + i]);
                (k ? normals : positions) = gathered[k].data();
            }
    }
    if (!positions) return;
    moved.positions.resize(3 * std::size_t(rows));
    Eigen::Map<Rows>(moved.positions.data(), rows, 3) = (Eigen::Map<const Rows>(positions, rows, 3) * by.linear().transpose()).rowwise() + by.translation().transpose();
    if (normals) {
        const Eigen::Matrix3f turn = by.linear() / std::cbrt(by.linear().determinant());
        moved.normals.resize(3 * std::size_t(rows));
        Eigen::Map<Rows>(moved.normals.data(), rows, 3) = Eigen::Map<const Rows>(normals, rows, 3) * turn.transpose();
    }
    body.positions = moved.positions.data();
    body.normals = normals ? moved.normals.data() : nullptr;
    body.deformSurface = -1;
    ContentHasher content;
    content.array(std::span<const float>(moved.positions));
    body.revision = content.key().low;
}

void BodyDrag::decorate(render::Scene& scene) const {
    if (const auto place = gizmo()) return addGizmo(scene, *place, space_, hovered_);
    if (const auto kept = keeps_.lock()) place(kept->by, kept->hanging, scene);
    if (!drag_ || !drag_->moved()) return;
    place(*drag_, parts().hanging, scene);
    drag_->decorate(scene);
    snap_.decorate(scene);
}

void BodyDrag::place(const TransformDrag& drag, const HangingParts& hanging, render::Scene& scene) const {
    const Vec3 origin = drag.placed(Vec3::Zero());
    Eigen::Affine3d by = Eigen::Affine3d::Identity();
    for (int k = 0; k < 3; ++k) by.linear().col(k) = drag.placed(Vec3::Unit(k)) - origin;
    by.translation() = origin;
    if (!allFinite(origin) || !(by.linear().determinant() > 0.0)) return;
    const auto goes = [&](std::uint64_t id) {
        const auto part = scenePart(id);
        if (!part) return false;
        switch (part->kind) {
            case ScenePart::Kind::Bone:
            case ScenePart::Kind::Endpoint: return hanging.bones.contains(part->part);
            case ScenePart::Kind::Character: return hanging.characters.contains(part->part);
            case ScenePart::Kind::Cut: {
                const CharacterSource* character = characterOf(document_.document(), {SelectionItem::Kind::Cut, part->part, {}, false});
                return character && hanging.characters.contains(character->id);
            }
            default: break;
        }
        return hanging.elements.contains(part->part);
    };
    for (render::Body& body : scene.bodies)
        if (body.mesh && goes(body.id)) carry(body, moved_[body.id], by.cast<float>());
    for (render::Marker& marker : scene.markers) {
        if (!goes(marker.id)) continue;
        marker.from = by * marker.from;
        marker.to = by * marker.to;
        for (Vec3& p : marker.outline) p = by * p;
    }
}

}  // namespace imomushi
