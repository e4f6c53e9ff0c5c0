// SPDX-License-Identifier: GPL-3.0-or-later
// The plane that is placed for a joint face or a cut: moved and turned by keys, by the pointer and by typed numbers.
#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "core/mesh/connectivity.h"
#include "ui/tools/face_tool.h"

namespace imomushi {

void FaceTool::movePlane(double steps) {
    previewPlane();
    const Element* of = element();
    if (!of) return;
    const double step = 0.005 * steps * of->mesh->connectivity().diagonal();
    plane_->origin += step * plane_->normal;
    plane_->shownOrigin += step * plane_->shownNormal;
    previewPlane();
}

bool FaceTool::editPlane(bool turns, const PointerEvent& e) {
    PlaneEdit edit;
    edit.before = edit_ ? edit_->before : *plane_;
    edit.before.dragging = false;
    edit.turns = turns;
    edit.last = e;
    edit.sight = e.viewForward;
    edit.held = alongLine(e, edit.before.shownOrigin, edit.before.shownNormal).value_or(0.0);
    edit_ = std::move(edit);
    snap_.begin();
    placeEdited();
    return true;
}

void FaceTool::followPlane(const PointerEvent& e) {
    PlaneEdit& edit = *edit_;
    const PointerEvent before = std::exchange(edit.last, e);
    const Plane& from = edit.before;
    if (edit.turns) {
        const auto middle = e.onScreen(from.shownOrigin);
        if (!middle) return;
        const Eigen::Vector2d a = Eigen::Vector2d(before.x, before.y) - *middle, b = Eigen::Vector2d(e.x, e.y) - *middle;
        if (a.norm() < kDragPixels || b.norm() < kDragPixels) return;
        // The screen's y goes down: about the way of the eye it counts as it is seen.
        edit.by += e.pace() * std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    } else if (const auto along = alongLine(e, from.shownOrigin, from.shownNormal)) {
        edit.by += e.pace() * (*along - edit.held);
        edit.held = *along;
    } else {
        edit.by += e.pace() * (e.y - before.y) * e.pixelAt(from.shownOrigin) * (from.shownNormal.dot(e.viewForward) < 0.0 ? 1.0 : -1.0);
    }
    placeEdited();
}

void FaceTool::placeEdited() {
    PlaneEdit& edit = *edit_;
    const Plane& from = edit.before;
    edit.goes = edit.by;
    if (!edit.typed.leads() && snap_.acts(edit.last)) edit.goes = edit.turns ? snap_.angle(edit.last, edit.by) : snap_.length(edit.last, edit.by, edit.last.pixelAt(from.shownOrigin));
    const double by = edit.typed.value(edit.goes);
    if (!std::isfinite(by)) return;
    *plane_ = from;
    if (edit.turns) {
        plane_->shownNormal = (Eigen::AngleAxisd(by, edit.sight) * from.shownNormal).normalized();
        plane_->normal = from.turn.conjugate() * plane_->shownNormal;
    } else {
        plane_->origin += by * from.normal;
        plane_->shownOrigin += by * from.shownNormal;
    }
    previewPlane();
    if (!plane_) edit_.reset();
}

QString FaceTool::banner() const { return edit_ ? edit_->typed.shown({edit_->goes, 0.0, 0.0}) : drag_.banner(); }

}  // namespace imomushi
