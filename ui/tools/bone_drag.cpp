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
    TransformDrag::Of of;
    for (const Point& point : points) of.pivot += point.shown / double(points.size());
    of.axes = gizmoAxes(space_, axesOfBone(document_.session(), document_.selection().empty() ? 0 : document_.selection().front().part), e.viewForward, e.viewRight);
    of.modal = modal;
    of.turns = points.size() > 1;  // one end alone has nothing to turn or to scale
    Drag drag{TransformDrag(does, of, e), std::move(points)};
    findImages(drag);
    drag_ = std::move(drag);
    snap_.begin({[this](const EndpointRef& end) {
                     const int index = document_.session().pointIndex(end);
                     return drag_ && std::any_of(drag_->points.begin(), drag_->points.end(), [&](const Point& p) { return p.index == index; });
                 },
                 {}});
    drag_->by.choose(does, snap_);
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
        if (!shownOf(document_.document(), item).picked()) continue;
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
    return withParts(place, gizmoParts_);
}

bool BoneDrag::press(render::GizmoPart part, const PointerEvent& e) {
    if (!start(TransformDrag::doneBy(part), chosen(), e, false)) return false;
    drag_->by.lockTo(part, snap_);
    return true;
}

bool BoneDrag::seeksPlace() const {
    return drag_ && drag_->by.does() == Does::Moves && drag_->points.size() == 1 && !drag_->by.locked() && !drag_->by.typing() && !snap_.settings().on && !snap_.acts(drag_->by.last());
}

void BoneDrag::move(const PointerEvent& e, const std::optional<Place>& near) {
    if (drag_->by.move(e, snap_)) drag_->near = seeksPlace() ? near : std::nullopt;
}

Vec3 BoneDrag::placed(const Point& point) const { return drag_->near ? drag_->near->shown : drag_->by.placed(point.shown); }

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
    const bool moved = drag_->by.moved();
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
    if (key == Qt::Key_Return || key == Qt::Key_Enter)
        keep();
    else if (drag_->by.key(key, modifiers, text, snap_))
        drag_->near.reset();
    return true;
}

QString BoneDrag::banner() const { return drag_ ? drag_->by.banner() : QString(); }

QString BoneDrag::hint() const {
    return snap_.before(drag_->by.modal() ? ToolTexts::tr("Click or Enter: keep · G, R, S: move, turn, scale · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel")
                        : drag_->by.does() != Does::Moves || drag_->points.size() > 1 || drag_->by.locked()
                            ? ToolTexts::tr("Release: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel")
                            : ToolTexts::tr("Release: the bone ends here · X, Y, Z: lock axis · Type a number · Ctrl: snap, and pass by joint faces · Esc: cancel"));
}

void BoneDrag::decorate(render::Scene& scene) const {
    if (!drag_ || !drag_->by.moved()) return;
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
    drag_->by.decorate(scene);
    snap_.decorate(scene);
}

}  // namespace imomushi
