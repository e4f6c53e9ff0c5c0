// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/pose_tool.h"

#include <cmath>
#include <numbers>

#include "core/base/finite.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/tools/picking.h"
#include "ui/tools/select_tool.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

constexpr double kRadiansPerPixel = 0.5 * std::numbers::pi / 180.0;
constexpr double kRadiansPerNotch = 5.0 * std::numbers::pi / 180.0;
/// The snapping grid is the power of ten (in metres) that is at least this many pixels wide.
constexpr double kSnapPixels = 12.0;

/// The plane in which the pointer is read: across the view, or holding the locked axis and facing the viewer as far as it can.
Vec3 dragPlane(const PointerEvent& e, int axis) {
    if (axis < 0) return e.viewForward;
    const Vec3 a = Vec3::Unit(axis);
    const Vec3 n = e.viewForward - a.dot(e.viewForward) * a;
    // Looking straight along the axis: it cannot be moved along with the pointer, and stays.
    return n.norm() > 0.05 ? Vec3(n.normalized()) : Vec3::Zero();
}

}  // namespace

std::optional<EndpointRef> PoseTool::endpointUnder(const PointerEvent& e) const {
    Session& session = document_.session();
    if (const auto end = pickEndpoint(session, e)) return end;
    // Pulling at the body pulls at the nearest end of a bone in it.
    const auto hits = rayHits(session, e.rayOrigin, e.rayDirection);
    if (hits.empty()) return std::nullopt;
    std::optional<EndpointRef> best;
    double nearest = 0.0;
    for (const auto& [id, bone] : session.document().bones) {
        if (bone->element != hits.front().element) continue;
        for (const bool atEnd : {true, false}) {
            const auto at = endpointPosition(session, {id, atEnd});
            if (!at) continue;
            const double distance = (*at - hits.front().point).norm();
            if (best && distance >= nearest) continue;
            nearest = distance;
            best = EndpointRef{id, atEnd};
        }
    }
    if (best) best = holdingEndpoint(session, *best);
    return best;
}

void PoseTool::press(const PointerEvent& e) {
    if (drag_ || e.button != Qt::LeftButton) return;
    const auto end = endpointUnder(e);
    const auto at = end ? endpointPosition(document_.session(), *end) : std::nullopt;
    if (!at) {
        selectByClick(document_, pickItem(document_.session(), e), e.modifiers);
        return;
    }
    const SelectionItem item{SelectionItem::Kind::Endpoint, end->bone, {}, end->atEnd};
    if (!(e.modifiers & Qt::ShiftModifier) || !document_.isSelected(item)) selectByClick(document_, item, e.modifiers);
    hovered_ = end;
    document_.setHovered(item);
    Drag drag;
    drag.end = *end;
    drag.origin = drag.target = *at;
    drag.pressX = drag.lastX = e.x;
    drag.pressY = e.y;
    drag.normal = dragPlane(e, -1);
    drag.grip = e.onPlane(*at, drag.normal, *at);
    if (const auto held = document_.document().goals.find(*end); held != document_.document().goals.end()) drag.roll = held->second.roll;
    drag_ = std::move(drag);
    last_ = e;
}

void PoseTool::move(const PointerEvent& e) {
    if (!drag_) {
        hovered_ = endpointUnder(e);
        if (hovered_)
            document_.setHovered(SelectionItem{SelectionItem::Kind::Endpoint, hovered_->bone, {}, hovered_->atEnd});
        else
            document_.setHovered(pickItem(document_.session(), e));
        return;
    }
    if (!drag_->gesture) {
        if (std::hypot(e.x - drag_->pressX, e.y - drag_->pressY) < kDragPixels) return;
        drag_->gesture = std::make_unique<Gesture>(document_);
    }
    follow(e);
    issue(e);
}

void PoseTool::follow(const PointerEvent& e) {
    Drag& drag = *drag_;
    const double pace = e.pace();
    if (turning_ || (e.modifiers & Qt::AltModifier)) {
        drag.roll = drag.roll.value_or(0.0) + pace * kRadiansPerPixel * (e.x - drag.lastX);
        if (drag.normal.norm() > 0.5) drag.grip = e.onPlane(drag.grip, drag.normal, drag.grip);
    } else if (drag.normal.norm() > 0.5) {
        const Vec3 under = e.onPlane(drag.grip, drag.normal, drag.grip);
        Vec3 step = pace * (under - drag.grip);
        if (drag.axis >= 0) step = Vec3::Unit(drag.axis) * step[drag.axis];
        drag.target += step;
        drag.grip = under;
    }
    drag.lastX = e.x;
    last_ = e;
}

void PoseTool::issue(const PointerEvent& e) {
    Drag& drag = *drag_;
    Vec3 to = drag.target;
    if (e.modifiers & Qt::ControlModifier) {
        const double grid = std::pow(10.0, std::ceil(std::log10(kSnapPixels * e.pixelAt(drag.target))));
        for (int k = 0; k < 3; ++k)
            if (drag.axis < 0 || drag.axis == k) to[k] = grid * std::round(to[k] / grid);
    }
    if (!allFinite(to)) return;
    if (!document_.execute(commands::drag(pathOf(document_.document(), drag.end), to, drag.roll))) cancel();
}

void PoseTool::release(const PointerEvent& e) {
    if (!drag_ || e.button != Qt::LeftButton) return;
    if (drag_->gesture) drag_->gesture->commit();
    drag_.reset();
    last_.reset();
    turning_ = false;
}

void PoseTool::doubleClick(const PointerEvent& e) {
    const auto end = endpointUnder(e);
    if (!end || !document_.document().goals.contains(*end)) return;
    document_.execute(commands::release(pathOf(document_.document(), *end)));
}

bool PoseTool::wheel(double notches, const PointerEvent& e) {
    if (!drag_) return false;
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    const double pace = e.pace();
    drag_->roll = drag_->roll.value_or(0.0) + pace * kRadiansPerNotch * notches;
    issue(e);
    return true;
}

bool PoseTool::key(int key, Qt::KeyboardModifiers) {
    if (key == Qt::Key_P) {
        if (drag_) return true;
        if (hovered_) {
            toggle(*hovered_);
            return true;
        }
        for (const SelectionItem& item : document_.selection())
            if (item.kind == SelectionItem::Kind::Endpoint) {
                toggle(holdingEndpoint(document_.session(), {item.part, item.atEnd}));
                return true;
            }
        return false;
    }
    if (!drag_) return false;
    if (key == Qt::Key_R) {
        turning_ = true;
        return true;
    }
    if (key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z) {
        const int axis = key - Qt::Key_X;
        drag_->axis = drag_->axis == axis ? -1 : axis;
        // The lock holds for the whole drag: what was moved across the axis is taken back.
        drag_->normal = dragPlane(*last_, drag_->axis);
        if (drag_->axis >= 0) {
            const double along = (drag_->target - drag_->origin)[axis];
            drag_->target = drag_->origin + along * Vec3::Unit(axis);
        }
        if (drag_->normal.norm() > 0.5) drag_->grip = last_->onPlane(drag_->target, drag_->normal, drag_->target);
        if (drag_->gesture) issue(*last_);
        return true;
    }
    return false;
}

bool PoseTool::wants(int key) const {
    if (key == Qt::Key_P) return drag_ || hovered_;
    return drag_ && (key == Qt::Key_R || key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z);
}

void PoseTool::keyReleased(int key) {
    if (key == Qt::Key_R) turning_ = false;
}

void PoseTool::toggle(const EndpointRef& end) {
    const Document& d = document_.document();
    document_.execute(commands::setPinned(pathOf(d, end), !isPinned(d, end)));
}

void PoseTool::cancel() {
    drag_.reset();  // its gesture takes the commands back
    last_.reset();
    turning_ = false;
}

QString PoseTool::hint() const {
    if (drag_) return ToolTexts::tr("X, Y, Z: lock axis · Shift: fine · Ctrl: grid · R or wheel: turn · Esc: cancel");
    if (document_.document().bones.empty()) return ToolTexts::tr("There are no bones yet. Place them with the bone tool.");
    if (hovered_) return ToolTexts::tr("Drag: pose · P: pin · Double click: let go");
    return ToolTexts::tr("Drag the end of a bone");
}

void PoseTool::decorate(render::Scene& scene) const {
    if (!drag_ || drag_->axis < 0) return;
    // The locked axis, long enough to leave the screen in both directions.
    const double reach = 4.0 * (scene.camera.eye - drag_->origin).norm() + scene.camera.orthoHeight;
    render::Marker line;
    line.shape = render::Marker::Shape::Axis;
    line.from = drag_->origin - reach * Vec3::Unit(drag_->axis);
    line.to = drag_->origin + reach * Vec3::Unit(drag_->axis);
    scene.markers.push_back(std::move(line));
}

}  // namespace imomushi
