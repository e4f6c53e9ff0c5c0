// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/handle_edit.h"

#include <algorithm>
#include <cmath>

#include "core/commands/handle_commands.h"
#include "core/mesh/connectivity.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Nearer to the middle than this, logical pixels, the pointer does not scale.
constexpr double kLeastReach = 4.0;

/// A vertex, of an element or of the render mesh of a character, at rest.
std::optional<Vec3> vertexAtRest(const Document& document, const Snap::Place& vertex) {
    if (const auto element = document.elements.find(vertex.of); element != document.elements.end()) return Vec3(element->second->mesh->body.vertices.row(vertex.index));
    if (const auto character = document.characters.find(vertex.of); character != document.characters.end()) return Vec3(character->second->model->mesh.body.vertices.row(vertex.index));
    return std::nullopt;
}

}  // namespace

std::shared_ptr<const Element> HandleEdit::element() const {
    const auto found = document_.document().elements.find(edit_->handle.element);
    const bool there = found != document_.document().elements.end() && found->second->handleOf(edit_->handle.face);
    return there ? found->second : nullptr;
}

bool HandleEdit::begin(Does does, const PointerEvent& e) {
    if (document_.selection().size() != 1) return false;
    const SelectionItem& item = document_.selection().front();
    const Handle* handle = shownOf(document_.document(), item).picked() ? handleOf(document_.document(), item) : nullptr;
    const auto pose = handle ? document_.session().poseOf({item.part, item.face}) : Result<HandlePose>(tl::unexpected(Error{}));
    if (!pose) return false;
    Edit edit;
    edit.does = does;
    edit.handle = {item.part, item.face};
    edit.point = handle->point;
    edit.radius = handle->radius;
    edit.seen = pose->at;
    edit.last = e;
    edit_ = std::move(edit);
    snap_.begin();
    return true;
}

double HandleEdit::radius() const {
    if (edit_->does == Does::Moves) return edit_->radius;
    const auto of = element();
    const double most = of ? kLargestHandleRadius * of->mesh->connectivity().diagonal() : edit_->radius;
    return std::clamp(edit_->typed.value(edit_->goes) * edit_->radius, 0.0, most);
}

void HandleEdit::preview() {
    edit_->face.reset();
    edit_->refusal.clear();
    edit_->moved = true;
    const auto of = element();
    if (!of) return cancel();
    auto face = handleFace(*of, edit_->point, radius(), edit_->handle.face);
    if (face)
        edit_->face = std::move(*face);
    else
        edit_->refusal = errorText(face.error());
}

void HandleEdit::move(const PointerEvent& e) {
    const PointerEvent before = std::exchange(edit_->last, e);
    if (edit_->does == Does::Moves) {
        const auto hit = surfaceUnder(document_.session(), e);
        if (!hit || hit->element != edit_->handle.element) return;  // it stays where it was last
        edit_->point = hit->rest;
        // Only a vertex is a place of the surface.
        snap_.point(e, hit->point, true);
        if (snap_.place() && snap_.place()->kind != Snap::Place::Kind::Vertex) snap_.clear();
        if (snap_.place())
            if (const auto rest = vertexAtRest(document_.document(), *snap_.place())) edit_->point = *rest;
        return preview();
    }
    const auto middle = e.onScreen(edit_->seen);
    if (!middle) return;
    const double from = (Eigen::Vector2d(before.x, before.y) - *middle).norm(), to = (Eigen::Vector2d(e.x, e.y) - *middle).norm();
    if (from < kLeastReach || to < kLeastReach) return;
    edit_->factor *= std::pow(to / from, e.pace());
    // The radius is in steps of the grid.
    const double wide = snap_.length(e, edit_->factor * edit_->radius, e.pixelAt(edit_->seen));
    edit_->goes = wide > 0.0 && edit_->radius > 0.0 ? wide / edit_->radius : edit_->factor;
    preview();
}

void HandleEdit::keep() {
    const Edit edit = *edit_;
    const double wide = radius();
    edit_.reset();
    if (!edit.moved) return;
    if (!edit.refusal.isEmpty()) return (void)Q_EMIT document_.failed(edit.refusal);
    const std::string& name = edit.handle.face;
    if (edit.does == Does::Moves)
        document_.execute(commands::placeHandle(name, edit.point));
    else
        document_.execute(commands::set(name, commands::handle::kRadius, wide));
}

bool HandleEdit::key(int key, const QString& text) {
    if (key == Qt::Key_Return || key == Qt::Key_Enter)
        keep();
    else if (edit_->does == Does::Scales && edit_->typed.key(key, text, TypedNumber::Of::Factor, {}))
        preview();
    else if ((key == Qt::Key_G && edit_->does != Does::Moves) || (key == Qt::Key_S && edit_->does != Does::Scales))
        begin(key == Qt::Key_G ? Does::Moves : Does::Scales, PointerEvent(edit_->last));
    return true;
}

QString HandleEdit::banner() const { return edit_ ? edit_->typed.shown({edit_->goes, 0.0, 0.0}) : QString(); }

QString HandleEdit::hint() const {
    if (!edit_->refusal.isEmpty()) return edit_->refusal + QStringLiteral(" · ") + ToolTexts::tr("Esc: cancel");
    if (edit_->does == Does::Moves) return snap_.before(ToolTexts::tr("Click or Enter: the handle goes here · S: radius · Ctrl: snap · Esc: cancel"));
    return ToolTexts::tr("Click or Enter: keep the radius (%1) · Type a number · G: place · Ctrl: snap · Esc: cancel").arg(lengthText(radius()));
}

void HandleEdit::decorate(render::Scene& scene) const {
    const auto of = element();
    if (!edit_->face || !of) return;
    addRim(scene, document_.session(), of->id, edit_->face->triangles);
    snap_.decorate(scene);
}

}  // namespace imomushi
