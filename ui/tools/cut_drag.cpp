// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/cut_drag.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/texts.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Where angles snap, normals this near to an axis of the world are that axis.
constexpr double kSnapCosine = 0.94;  // 20 degrees
/// Squared sine of the angle between the view and the normal: below it (6 degrees) the pointer goes up and down for the plane to come nearer or go away.
constexpr double kAlong = 0.01;

/// Distance from the pointer to the segment a...b on the screen, pixels of the design; infinite where an end is behind the eye.
double pixelsTo(const PointerEvent& e, const Vec3& a, const Vec3& b) {
    const auto from = e.onScreen(a), to = e.onScreen(b);
    if (!from || !to) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d along = *to - *from, off = Eigen::Vector2d(e.x, e.y) - *from;
    const double square = along.squaredNorm(), t = square > 0.0 ? std::clamp(off.dot(along) / square, 0.0, 1.0) : 0.0;
    return (off - t * along).norm();
}

}  // namespace

std::optional<double> alongLine(const PointerEvent& e, const Vec3& point, const Vec3& direction) {
    const double across = direction.dot(e.rayDirection), square = 1.0 - across * across;
    if (square < kAlong) return std::nullopt;
    const Vec3 w = e.rayOrigin - point;
    return (w.dot(direction) - across * w.dot(e.rayDirection)) / square;
}

std::optional<CutDrag::Grip> CutDrag::chosen() const {
    if (document_.selection().size() != 1 || !keeps_.expired()) return std::nullopt;  // the cut is not yet where it is seen
    const SelectionItem& item = document_.selection().front();
    if (!cutOf(document_.document(), item) || !shownOf(document_.document(), item).picked()) return std::nullopt;
    const auto frame = cutFrame(document_.session(), item.part);
    return frame ? std::optional(Grip{item.part, false, *frame}) : std::nullopt;
}

std::optional<CutDrag::Grip> CutDrag::grip(const PointerEvent& e) const {
    auto found = chosen();
    if (!found) return std::nullopt;
    const CutFrame* frame = &found->frame;
    const auto turning = [&] {
        found->turns = true;
        return found;
    };
    const auto tip = e.onScreen(frame->centre + frame->reach * frame->normal);
    // Seen along its normal, the plane has its arrow over its middle, and is not turned by that.
    const auto centre = e.onScreen(frame->centre);
    if (tip && centre && (*tip - *centre).norm() > kEndpointPixels && (*tip - Eigen::Vector2d(e.x, e.y)).norm() <= kEndpointPixels) return turning();
    // The square around the section, as it is drawn; seen from its edge, whatever is near to the line that it is then.
    const Vec3 beside = frame->centre + 2.0 * frame->reach * frame->normal;
    if ((e.onPlane(frame->centre, frame->normal, beside) - frame->centre).norm() <= frame->reach) return found;
    const Vec3 x = frame->normal.unitOrthogonal(), y = frame->normal.cross(x);
    std::vector<std::vector<Vec3>> lines = frame->rim;
    lines.push_back({frame->centre - frame->reach * x, frame->centre + frame->reach * x});
    lines.push_back({frame->centre - frame->reach * y, frame->centre + frame->reach * y});
    for (const auto& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i)
            if (pixelsTo(e, line[i], line[(i + 1) % line.size()]) <= kBonePixels) return found;
    return std::nullopt;
}

bool CutDrag::press(const PointerEvent& e) {
    if (drag_ || e.button != Qt::LeftButton) return false;
    auto taken = grip(e);
    return taken && take(std::move(*taken), e, false);
}

bool CutDrag::begin(bool turns, const PointerEvent& e) {
    auto taken = chosen();
    if (!taken) return false;
    taken->turns = turns;
    return take(std::move(*taken), e, true);
}

bool CutDrag::take(Grip grip, const PointerEvent& e, bool modal) {
    const auto& character = *characterOf(document_.document(), {SelectionItem::Kind::Cut, grip.cut, {}, false});
    Drag drag;
    drag.centre = grip.frame.centre;
    drag.normal = drag.turned = drag.faced = grip.frame.normal;
    drag.sight = e.viewForward;
    const Vec3 tip = drag.centre + grip.frame.reach * drag.normal;
    drag.held = grip.turns ? e.onPlane(tip, e.viewForward, tip) : Vec3(drag.centre + alongLine(e, drag.centre, drag.normal).value_or(0.0) * drag.normal);
    drag.pressed = {e.x, e.y};
    drag.lastY = e.y;
    drag.modal = modal;
    drag.last = e;
    drag.grip = std::move(grip);
    drag.body = character.body;
    drag_ = std::move(drag);
    snap_.begin();
    return true;
}

void CutDrag::move(const PointerEvent& e) {
    if (!drag_) return;
    Drag& drag = *drag_;
    drag.last = e;
    if (!drag.moved && (Eigen::Vector2d(e.x, e.y) - drag.pressed).norm() < kDragPixels) return;
    drag.moved = true;
    const CutFrame& frame = drag.grip.frame;
    if (drag.grip.turns) {
        const Vec3 under = e.onPlane(drag.held, e.viewForward, drag.held);
        const Vec3 tip = frame.centre + frame.reach * drag.turned + e.pace() * (under - drag.held);
        drag.held = under;
        drag.sight = e.viewForward;
        if ((tip - frame.centre).norm() > 1e-3 * frame.reach) drag.turned = (tip - frame.centre).normalized();
    } else if (const auto along = alongLine(e, frame.centre, frame.normal); !along) {
        drag.along += e.pace() * (e.y - drag.lastY) * e.pixelAt(frame.centre) * (frame.normal.dot(e.viewForward) < 0.0 ? 1.0 : -1.0);
    } else {
        drag.along += e.pace() * (*along - (drag.held - frame.centre).dot(frame.normal));
        drag.held = frame.centre + *along * frame.normal;
    }
    drag.lastY = e.y;
    settle();
    place();
}

void CutDrag::settle() {
    Drag& drag = *drag_;
    const CutFrame& frame = drag.grip.frame;
    drag.slid = drag.along;
    drag.faced = drag.turned;
    if (drag.typed.leads() || !snap_.acts(drag.last) || drag.grip.turns) snap_.clear();
    if (drag.typed.leads() || !snap_.acts(drag.last)) return;
    if (!drag.grip.turns) {
        // Through the place under the pointer; on the grid as far from the origin as steps are.
        snap_.point(drag.last, frame.centre + drag.along * frame.normal, true);
        const double from = frame.centre.dot(frame.normal);
        if (snap_.place() && snap_.place()->kind != Snap::Place::Kind::Grid)
            drag.slid = snap_.place()->at.dot(frame.normal) - from;
        else
            drag.slid = snap_.length(drag.last, from + drag.along, drag.last.pixelAt(frame.centre)) - from;
        if (snap_.place() && snap_.place()->kind == Snap::Place::Kind::Grid) snap_.clear();
        return;
    }
    if (!snap_.settings().angle) return;
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(drag.turned[axis]) > kSnapCosine) return void(drag.faced = std::copysign(1.0, drag.turned[axis]) * Vec3::Unit(axis));
    const Vec3 about = frame.normal.cross(drag.turned);
    if (about.norm() > 1e-9) drag.faced = Eigen::AngleAxisd(snap_.angle(drag.last, std::atan2(about.norm(), frame.normal.dot(drag.turned))), about.normalized()) * frame.normal;
}

double CutDrag::pointed() const {
    const Drag& drag = *drag_;
    if (!drag.grip.turns) return drag.slid;
    // As the turn is seen.
    const Vec3 from = drag.grip.frame.normal;
    return std::atan2(drag.sight.dot(from.cross(drag.faced)), from.dot(drag.faced));
}

void CutDrag::place() {
    Drag& drag = *drag_;
    const CutFrame& frame = drag.grip.frame;
    const double by = drag.typed.value(pointed());
    drag.normal = drag.faced;
    if (!drag.grip.turns)
        drag.centre = frame.centre + by * frame.normal;
    else if (drag.typed.leads())
        drag.normal = (Eigen::AngleAxisd(by, drag.sight) * frame.normal).normalized();
    preview();
}

CutPlane CutDrag::plane() const {
    const CutFrame& frame = drag_->grip.frame;
    return {frame.atRest(drag_->centre), frame.rotation.inverse() * drag_->normal};
}

void CutDrag::preview() {
    drag_->outline.clear();
    drag_->refusal.clear();
    const CutFrame& frame = drag_->grip.frame;
    const auto sections = sections_.of(drag_->body, drag_->body->mesh);
    if (!sections) return;
    const auto outline = sections->at(plane());
    if (!outline) {
        drag_->refusal = errorText(outline.error());
        return;
    }
    const TriangleMesh& body = sections->body();
    drag_->outline = sections->placed(*outline, [&](std::int32_t v) { return Vec3(frame.centre + frame.rotation * (body.vertices.row(v).transpose() - frame.restCentre)); });
}

void CutDrag::release(const PointerEvent& e) {
    if (drag_ && !drag_->modal && e.button == Qt::LeftButton) keep();
}

void CutDrag::keep() {
    const CutPlane to = plane();
    const auto kept = std::make_shared<const Drag>(std::move(*drag_));
    drag_.reset();
    const Cut* cut = cutOf(document_.document(), {SelectionItem::Kind::Cut, kept->grip.cut, {}, false});
    if (!kept->moved || !cut) return;
    const std::string name = cut->name;
    const auto nearest = std::make_shared<std::optional<CutPlane>>();
    SlowStep step;
    step.command = commands::moveCut(name, to.origin, to.normal);
    step.lookFurther = [nearest, to, element = kept->grip.frame.elements[0], moved = kept->grip.cut](const Document& document) { *nearest = nearestCut(document, element, moved, to); };
    step.done = [kept](const Json&) {};  // until then it is seen
    step.refused = [&document = document_, nearest, name](const Error& error) {
        const QString reason = errorText(error);
        if (*nearest) Q_EMIT document.offered(reason, ToolTexts::tr("Move it to the nearest place that works"), commands::moveCut(name, (*nearest)->origin, (*nearest)->normal));
        else Q_EMIT document.failed(reason);
    };
    keeps_ = kept;
    document_.executeSlow(std::move(step));
}

bool CutDrag::key(int key, const QString& text) {
    if (!drag_) return false;
    if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        keep();
        return true;
    }
    if (drag_->modal && (key == Qt::Key_G || key == Qt::Key_R)) return begin(key == Qt::Key_R, PointerEvent(drag_->last));
    if (key == Qt::Key_X || key == Qt::Key_Y || key == Qt::Key_Z) {
        const Vec3 axis = Vec3::Unit(key - Qt::Key_X);
        drag_->turned = drag_->faced = axis.dot(drag_->normal) < 0.0 ? Vec3(-axis) : axis;
        if (drag_->grip.turns) drag_->typed.clear();
    } else if (!drag_->typed.key(key, text, drag_->grip.turns ? TypedNumber::Of::Angle : TypedNumber::Of::Length, {})) {
        return false;
    } else {
        settle();
    }
    drag_->moved = true;
    place();
    return true;
}

QString CutDrag::banner() const { return drag_ ? drag_->typed.shown({pointed(), 0.0, 0.0}) : QString(); }

QString CutDrag::hint() const {
    if (!drag_) return ToolTexts::tr("Drag the plane or G: move the cut · Drag its arrow: turn · Delete: remove");
    const QString keys = drag_->modal ? ToolTexts::tr("Click or Enter: cut here · G, R: move, turn · Type a number · Shift: fine · Ctrl: snap · X, Y, Z: turn · Esc: cancel") : ToolTexts::tr("Release: cut here · Type a number · Shift: fine · Ctrl: snap · X, Y, Z: turn · Esc: cancel");
    return drag_->refusal.isEmpty() ? snap_.before(keys) : drag_->refusal + QStringLiteral(" · ") + ToolTexts::tr("Esc: cancel");
}

void CutDrag::decorate(render::Scene& scene) const {
    if (const auto kept = keeps_.lock()) decorate(*kept, scene);
    if (!drag_ || !drag_->moved) return;
    decorate(*drag_, scene);
    snap_.decorate(scene);
}

void CutDrag::decorate(const Drag& drag, render::Scene& scene) {
    render::Marker plane;
    plane.shape = render::Marker::Shape::PlaneGizmo;
    plane.from = drag.centre;
    plane.to = drag.centre + drag.grip.frame.reach * drag.normal;
    plane.hovered = true;
    scene.markers.push_back(std::move(plane));
    for (const auto& loop : drag.outline) {
        render::Marker rim;
        rim.shape = render::Marker::Shape::FaceOutline;
        rim.outline = loop;
        rim.from = rim.to = loop.front();
        rim.hovered = true;
        scene.markers.push_back(std::move(rim));
    }
}

}  // namespace imomushi
