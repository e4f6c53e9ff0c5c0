// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/bone_drag.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"
#include "core/document/character_input.h"
#include "ui/models/commands.h"
#include "ui/models/gesture.h"
#include "ui/models/paths.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

/// Nearer to the pivot than this, logical pixels, the pointer neither turns nor scales.
constexpr double kLeastBoneArm = 4.0;

const Bone::Place* placeOf(const Document& document, const EndpointRef& end) {
    const auto bone = document.bones.find(end.bone);
    if (bone == document.bones.end()) return nullptr;
    return end.atEnd ? &bone->second->end : &bone->second->start;
}

}  // namespace

std::optional<BoneDrag::Point> BoneDrag::pointOf(const EndpointRef& end) const {
    const Session& session = document_.session();
    const Document& d = document_.document();
    const int index = session.pointIndex(end);
    const auto shown = endpointPosition(session, end);
    const auto rest = endpointRestPosition(d, end);
    if (index < 0 || !shown || !rest) return std::nullopt;
    Point point;
    point.index = index;
    point.shown = *shown;
    point.rest = *rest;
    for (const auto& [id, bone] : d.bones)
        for (const bool atEnd : {true, false}) {
            const EndpointRef other{id, atEnd};
            if (session.pointIndex(other) == index && !std::holds_alternative<EndpointRef>(*placeOf(d, other))) point.ends.push_back(other);
        }
    if (point.ends.empty()) return std::nullopt;
    // A bone must touch its parent whenever it changes: the parent goes first.
    const auto hangs = [&](const EndpointRef& e) {
        const PartId parent = d.bones.at(e.bone)->parent;
        return std::any_of(point.ends.begin(), point.ends.end(), [&](const EndpointRef& other) { return other.bone == parent; });
    };
    std::stable_partition(point.ends.begin(), point.ends.end(), [&](const EndpointRef& e) { return !hangs(e); });
    const auto& frames = session.shownPose().frames;
    if (const int bone = session.plan().boneIndex(point.ends.front().bone); bone >= 0 && std::size_t(bone) < frames.size()) point.turn = frames[std::size_t(bone)];
    return point;
}

bool BoneDrag::start(Does does, std::vector<Point> points, const PointerEvent& e, bool modal) {
    if (points.empty()) return false;
    Drag drag;
    for (const Point& point : points) drag.pivot += point.shown / double(points.size());
    drag.points = std::move(points);
    drag.first = drag.last = e;
    drag.modal = modal;
    drag.lock.setFrame(gizmoAxes(space_, axesOfBone(document_.session(), document_.selection().empty() ? 0 : document_.selection().front().part), e.viewForward, e.viewRight));
    findImages(drag);
    drag_ = std::move(drag);
    snap_.begin({[this](const EndpointRef& end) {
                     const int index = document_.session().pointIndex(end);
                     return drag_ && std::any_of(drag_->points.begin(), drag_->points.end(), [&](const Point& p) { return p.index == index; });
                 },
                 {}});
    choose(does);
    return true;
}

bool BoneDrag::press(const EndpointRef& end, const PointerEvent& e) {
    auto point = pointOf(end);
    return point && start(Does::Moves, {std::move(*point)}, e, false);
}

std::vector<BoneDrag::Point> BoneDrag::chosen() const {
    std::vector<Point> points;
    const auto add = [&](const EndpointRef& end) {
        auto point = pointOf(end);
        if (point && std::none_of(points.begin(), points.end(), [&](const Point& p) { return p.index == point->index; })) points.push_back(std::move(*point));
    };
    for (const SelectionItem& item : document_.selection()) {
        if (item.kind == SelectionItem::Kind::Endpoint) add({item.part, item.atEnd});
        if (item.kind == SelectionItem::Kind::Bone)
            for (const bool atEnd : {false, true}) add({item.part, atEnd});
    }
    return points;
}

bool BoneDrag::begin(Does does, const PointerEvent& e) { return start(does, chosen(), e, true); }

std::optional<GizmoPlace> BoneDrag::gizmo() const {
    const auto points = chosen();
    if (points.empty()) return std::nullopt;
    GizmoPlace place;
    for (const Point& point : points) place.at += point.shown / double(points.size());
    place.turns = place.scales = points.size() > 1;
    place.local = axesOfBone(document_.session(), document_.selection().front().part);
    return place;
}

bool BoneDrag::press(render::GizmoPart part, const PointerEvent& e) {
    const bool scales = render::isOneOf(part, render::GizmoPart::ScaleX);
    if (!start(turnsBy(part) ? Does::Turns : scales ? Does::Scales : Does::Moves, chosen(), e, false)) return false;
    lockTo(drag_->lock, part);
    choose(drag_->does);
    return true;
}

void BoneDrag::choose(Does does) {
    Drag& drag = *drag_;
    drag.does = does;
    drag.typed.clear();
    drag.step = Vec3::Zero();
    drag.angle = 0.0;
    drag.factor = 1.0;
    drag.near.reset();
    drag.first = drag.last;
    const Vec3 plane = drag.lock.plane(drag.last);
    drag.grip = drag.last.onPlane(drag.pivot, plane, drag.pivot);
    settle();
}

bool BoneDrag::seeksPlace() const {
    return drag_ && drag_->does == Does::Moves && drag_->points.size() == 1 && drag_->lock.free() && !drag_->typed.leads() && !snap_.settings().on && !snap_.acts(drag_->last);
}

void BoneDrag::move(const PointerEvent& e, const std::optional<Place>& near) {
    Drag& drag = *drag_;
    const PointerEvent before = std::exchange(drag.last, e);
    if (!drag.moved && !drag.modal && std::hypot(e.x - drag.first.x, e.y - drag.first.y) < kDragPixels) return;
    drag.moved = true;
    drag.near = seeksPlace() ? near : std::nullopt;
    follow(before, e);
    settle();
}

void BoneDrag::follow(const PointerEvent& before, const PointerEvent& e) {
    Drag& drag = *drag_;
    if (drag.does == Does::Moves) {
        const Vec3 plane = drag.lock.plane(e);
        if (plane.norm() < 0.5) return;
        const Vec3 under = e.onPlane(drag.grip, plane, drag.grip);
        drag.step += drag.lock.confined(e.pace() * (under - drag.grip));
        drag.grip = under;
        return;
    }
    const auto middle = e.onScreen(drag.pivot);
    if (!middle) return;
    const Eigen::Vector2d from = Eigen::Vector2d(before.x, before.y) - *middle, to = Eigen::Vector2d(e.x, e.y) - *middle;
    if (from.norm() < kLeastBoneArm || to.norm() < kLeastBoneArm) return;
    if (drag.does == Does::Scales) {
        drag.factor *= std::pow(to.norm() / from.norm(), e.pace());
        return;
    }
    // Counted as it is seen: the screen's y goes down.
    const double by = std::atan2(from.y() * to.x() - from.x() * to.y(), from.dot(to));
    const double side = drag.lock.alongAxis() && turningAxis().dot(e.viewForward) > 0.0 ? -1.0 : 1.0;
    drag.angle += e.pace() * side * by;
}

Vec3 BoneDrag::turningAxis() const { return drag_->lock.alongAxis() ? drag_->lock.direction() : Vec3(-drag_->last.viewForward); }

TypedNumber::Of BoneDrag::of() const {
    switch (drag_->does) {
        case Does::Turns: return TypedNumber::Of::Angle;
        case Does::Scales: return TypedNumber::Of::Factor;
        case Does::Moves: break;
    }
    return TypedNumber::Of::Length;
}

std::string BoneDrag::axes() const { return drag_->does == Does::Moves ? drag_->lock.axes() : std::string(); }

void BoneDrag::settle() {
    Drag& drag = *drag_;
    PointerEvent e = drag.last;
    e.bonesVisible = true;
    const bool snaps = drag.does == Does::Moves && drag.moved && !drag.typed.leads();
    if (!snaps) snap_.clear();
    switch (drag.does) {
        case Does::Turns: drag.goes = {snap_.angle(e, drag.angle), 0.0, 0.0}; break;
        case Does::Scales: drag.goes = {snap_.factor(e, drag.factor), 0.0, 0.0}; break;
        case Does::Moves: {
            const Vec3 to = snaps ? Vec3(snap_.point(e, drag.pivot + drag.step, !drag.lock.free())) : Vec3(drag.pivot + drag.step);
            drag.goes = drag.lock.toAxes(to - drag.pivot);
            break;
        }
    }
}

Vec3 BoneDrag::placed(const Point& point) const {
    const Drag& drag = *drag_;
    if (drag.near) return drag.near->shown;
    const auto values = drag.typed.values(pointed());
    const Vec3 arm = point.shown - drag.pivot;
    if (drag.does == Does::Moves) return point.shown + drag.lock.fromAxes(values);
    if (drag.does == Does::Turns) return drag.pivot + Eigen::AngleAxisd(values[0], turningAxis()) * arm;
    return drag.pivot + arm + (values[0] - 1.0) * drag.lock.confined(arm);
}

void BoneDrag::findImages(Drag& drag) const {
    if (!symmetry_) return;
    const Session& session = document_.session();
    drag.symmetry = Symmetry::ofBone(document_.document(), drag.points.front().ends.front().bone);
    for (std::size_t i = 0; i < drag.points.size(); ++i) {
        const EndpointRef end = drag.points[i].ends.front();
        const auto image = drag.symmetry->imageOf(session, end);
        if (!image) {
            if (!drag.symmetry->central(document_.document(), {end, {}})) drag.alone.push_back(end);
            continue;
        }
        // Both sides are dragged, each as the pointer says.
        const int index = session.pointIndex(*image);
        if (std::any_of(drag.points.begin(), drag.points.end(), [&](const Point& p) { return p.index == index; })) continue;
        if (auto point = pointOf(*image)) drag.images.push_back({std::move(*point), i});
    }
}

bool BoneDrag::place(const Goal& goal) {
    const Document& d = document_.document();
    const EndpointRef leads = goal.ends.front();
    for (const EndpointRef& end : goal.ends) {
        const auto bone = d.bones.find(end.bone);
        if (bone == d.bones.end()) return false;
        const std::variant<std::string, Vec3> place = end == leads ? goal.place : std::variant<std::string, Vec3>(pathOf(d, leads));
        if (!document_.execute(commands::placeEnd(bone->second->name, end.atEnd, place))) return false;
    }
    return true;
}

bool BoneDrag::keep() {
    const bool moved = drag_->moved;
    std::vector<Goal> all, images;
    const Document& d = document_.document();
    const auto hung = [&](const Bone::Place& place) -> std::variant<std::string, Vec3> {
        if (const auto* face = std::get_if<FaceRef>(&place)) return pathOf(d, *face);
        if (const auto* end = std::get_if<EndpointRef>(&place)) return pathOf(d, *end);
        return std::get<Vec3>(place);
    };
    for (std::size_t i = 0; i < drag_->points.size(); ++i) {
        const Point& point = drag_->points[i];
        Vec3 rest = point.rest + point.turn.conjugate() * (placed(point) - point.shown);
        Goal to{point.ends, rest};
        if (drag_->near) {
            to.place = hung(drag_->near->place);
            if (const auto at = restPosition(d, drag_->near->place)) rest = *at;
        }
        for (const Image& image : drag_->images) {
            if (image.of != i) continue;
            const Vec3 there = drag_->symmetry->point(rest);
            const double size = (image.point.rest - there).norm() + (point.rest - rest).norm();
            images.push_back({image.point.ends, drag_->near ? hung(Symmetry::placeAt(d, there, image.point.ends, size)) : std::variant<std::string, Vec3>(there)});
        }
        all.push_back(std::move(to));
    }
    const std::vector<EndpointRef> alone = std::move(drag_->alone);
    drag_.reset();
    if (!moved) return false;
    for (const Goal& to : all)
        if (const auto* point = std::get_if<Vec3>(&to.place); point && !allFinite(*point)) return true;
    const auto move = [&](bool mirrored) {
        Gesture gesture(document_);
        for (const Goal& to : all)
            if (!place(to)) return false;
        if (mirrored)
            for (const Goal& to : images)
                if (!place(to)) return false;
        gesture.commit();
        return true;
    };
    // What the other side refuses, as the document says, this one does alone.
    if (!move(true) && !images.empty()) move(false);
    if (!alone.empty()) Q_EMIT document_.failed(ToolTexts::tr("“%1” has nothing on the other side: it moved alone.").arg(QString::fromStdString(pathOf(d, alone.front()))));
    return true;
}

bool BoneDrag::key(int key, Qt::KeyboardModifiers modifiers, const QString& text) {
    Drag& drag = *drag_;
    if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        keep();
    } else if (drag.typed.key(key, text, of(), axes())) {
        drag.moved = true;
        settle();
    } else if (drag.lock.key(key, modifiers)) {
        drag.step = drag.lock.confined(drag.step);
        drag.grip = drag.last.onPlane(drag.pivot + drag.step, drag.lock.plane(drag.last), drag.pivot + drag.step);
        drag.near.reset();
        if (drag.does == Does::Moves) drag.typed.setAxes(axes());
        settle();
    } else if (key == Qt::Key_G || key == Qt::Key_R || key == Qt::Key_S) {
        // One end alone has nothing to turn or to scale.
        if (key == Qt::Key_G || drag.points.size() > 1) choose(key == Qt::Key_G ? Does::Moves : key == Qt::Key_R ? Does::Turns : Does::Scales);
    }
    return true;
}

QString BoneDrag::banner() const {
    if (!drag_) return {};
    const QString typed = drag_->typed.shown(pointed());
    return typed.isEmpty() ? drag_->lock.text(drag_->last) : typed;
}

QString BoneDrag::hint() const {
    return snap_.before(drag_->modal ? ToolTexts::tr("Click or Enter: keep · G, R, S: move, turn, scale · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel")
                        : drag_->does != Does::Moves || drag_->points.size() > 1 || !drag_->lock.free()
                            ? ToolTexts::tr("Release: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel")
                            : ToolTexts::tr("Release: the bone ends here · X, Y, Z: lock axis · Type a number · Ctrl: snap, and pass by joint faces · Esc: cancel"));
}

void BoneDrag::decorate(render::Scene& scene) const {
    if (!drag_ || !drag_->moved) return;
    const Session& session = document_.session();
    const auto shownImage = [&](const Image& image) -> Vec3 {
        const Point& of = drag_->points[image.of];
        return image.point.shown + Symmetry::way(placed(of) - of.shown);
    };
    const auto placeOfPoint = [&](const EndpointRef& end) -> std::optional<Vec3> {
        const int index = session.pointIndex(end);
        for (const Point& point : drag_->points)
            if (point.index == index) return placed(point);
        for (const Image& image : drag_->images)
            if (image.point.index == index) return shownImage(image);
        return endpointPosition(session, end);
    };
    for (const auto& [id, bone] : document_.document().bones) {
        const auto touches = [&, b = id](const Point& p) { return p.index == session.pointIndex({b, false}) || p.index == session.pointIndex({b, true}); };
        const bool touched = std::any_of(drag_->points.begin(), drag_->points.end(), touches) || std::any_of(drag_->images.begin(), drag_->images.end(), [&](const Image& i) { return touches(i.point); });
        const auto from = placeOfPoint({id, false}), to = placeOfPoint({id, true});
        if (!touched || !from || !to || !allFinite(*from) || !allFinite(*to)) continue;
        render::Marker marker;
        marker.shape = render::Marker::Shape::Bone;
        marker.from = *from;
        marker.to = *to;
        marker.hovered = true;
        scene.markers.push_back(std::move(marker));
    }
    for (const Point& point : drag_->points) {
        render::Marker marker;
        marker.shape = render::Marker::Shape::JointPoint;
        marker.from = placed(point);
        marker.hovered = true;
        if (allFinite(marker.from)) scene.markers.push_back(std::move(marker));
    }
    drag_->lock.decorate(scene, drag_->pivot);
    snap_.decorate(scene);
}

}  // namespace imomushi
