// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/gizmo.h"

#include <memory>
#include <numbers>

#include "core/base/finite.h"
#include "ui/picking/picking.h"
#include "ui/tools/tool_texts.h"

namespace imomushi {
namespace {

using render::GizmoPart;
using Sizes = render::GizmoSizes;

/// How far beside a part, pixels of the design, a press still means it.
constexpr double kBesidePixels = 6.0, kMiddlePixels = 9.0;
constexpr double kLeastFade = 0.02;

double toSegment(const Eigen::Vector2d& q, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d d = b - a;
    const double square = d.squaredNorm(), t = square > 0.0 ? std::clamp((q - a).dot(d) / square, 0.0, 1.0) : 0.0;
    return (a + t * d - q).norm();
}

}  // namespace

Eigen::Matrix3d gizmoAxes(GizmoSpace space, const Eigen::Matrix3d& local, const Vec3& forward, const Vec3& right) {
    if (space == GizmoSpace::Local) return local;
    if (space == GizmoSpace::World) return Eigen::Matrix3d::Identity();
    Eigen::Matrix3d axes;
    axes << right, right.cross(forward), -forward;
    return axes;
}

Eigen::Matrix3d axesOfBone(const Session& session, PartId bone) {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    const auto from = endpointPosition(session, {bone, false}), to = endpointPosition(session, {bone, true});
    const Vec3 along = from && to ? Vec3(*to - *from) : Vec3(Vec3::Zero());
    if (!allFinite(along) || along.norm() < 1e-12) return axes;
    const Vec3 x = along.normalized(), helper = std::abs(x.y()) < 0.9 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ());
    const Vec3 y = (helper - helper.dot(x) * x).normalized();
    axes << x, y, x.cross(y);
    return axes;
}

GizmoPlace withParts(GizmoPlace place, GizmoParts parts) {
    if (parts == GizmoParts::Move) place.turns = place.scales = false;
    if (parts == GizmoParts::Turn && place.turns) place.moves = place.scales = false;
    if (parts == GizmoParts::Scale && place.scales) place.moves = place.turns = false;
    return place;
}

bool turnsBy(GizmoPart part) { return part == GizmoPart::RingView || render::isOneOf(part, GizmoPart::RingX); }

void lockTo(AxisLock& lock, GizmoPart part) {
    for (const GizmoPart first : {GizmoPart::AxisX, GizmoPart::PlaneX, GizmoPart::RingX, GizmoPart::ScaleX})
        if (render::isOneOf(part, first)) lock.lockTo(int(part) - int(first), first == GizmoPart::PlaneX);
}

GizmoPart gizmoUnder(const PointerEvent& e, const GizmoPlace& place, GizmoSpace space) {
    const auto centre = e.onScreen(place.at);
    if (!centre) return GizmoPart::None;
    const Eigen::Vector2d q(e.x, e.y);
    const double fromCentre = (q - *centre).norm(), metres = e.pixelAt(place.at);
    if (fromCentre > Sizes::kReach + kBesidePixels) return GizmoPart::None;
    if (place.moves && fromCentre <= kMiddlePixels) return GizmoPart::Middle;
    const Vec3 view = e.pixelSize > 0.0 ? e.viewForward : Vec3((place.at - e.rayOrigin).normalized());
    const Eigen::Matrix3d axes = gizmoAxes(space, place.local, e.viewForward, e.viewRight);
    const auto at = [&](const Vec3& pixels) { return e.onScreen(place.at + metres * pixels); };
    for (int k = 0; k < 3; ++k) {
        const Vec3 axis = axes.col(k);
        if (render::axisFade(axis, view) < kLeastFade) continue;
        const auto box = at(Sizes::kScale * axis), stem = at(Sizes::kStem * axis), tip = at(Sizes::kTip * axis);
        if (place.scales && box && (*box - q).norm() <= Sizes::kBox + kBesidePixels - 1.0) return render::partOf(GizmoPart::ScaleX, k);
        if (place.moves && stem && tip && toSegment(q, *stem, *tip) <= kBesidePixels) return render::partOf(GizmoPart::AxisX, k);
    }
    for (int k = 0; k < 3 && place.moves; ++k) {
        if (render::planeFade(axes.col(k), view) < kLeastFade) continue;
        const auto corners = render::gizmoPlane(axes, k, view);
        Eigen::Vector2d s[4];
        bool all = true;
        for (int i = 0; i < 4 && all; ++i) {
            const auto p = at(corners[std::size_t(i)]);
            all = p.has_value();
            if (p) s[i] = *p;
        }
        if (!all) continue;
        int left = 0;
        for (int i = 0; i < 4; ++i) {
            const Eigen::Vector2d edge = s[(i + 1) % 4] - s[i], to = q - s[i];
            left += edge.x() * to.y() - edge.y() * to.x() > 0.0 ? 1 : -1;
        }
        if (std::abs(left) == 4) return render::partOf(GizmoPart::PlaneX, k);
    }
    if (!place.turns) return GizmoPart::None;
    for (int k = 0; k < 3; ++k) {
        if (render::planeFade(axes.col(k), view) < kLeastFade) continue;
        const Vec3 a = axes.col((k + 1) % 3), b = axes.col((k + 2) % 3);
        std::optional<Eigen::Vector2d> before;
        for (int i = 0; i <= Sizes::kSides; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / Sizes::kSides;
            const Vec3 p = Sizes::kRing * (std::cos(angle) * a + std::sin(angle) * b);
            auto now = p.dot(view) <= 0.0 ? at(p) : std::nullopt;  // the half that faces the viewer
            if (before && now && toSegment(q, *before, *now) <= kBesidePixels) return render::partOf(GizmoPart::RingX, k);
            before = now;
        }
    }
    return std::abs(fromCentre - Sizes::kRingView) <= kBesidePixels ? GizmoPart::RingView : GizmoPart::None;
}

void addGizmo(render::Scene& scene, const GizmoPlace& place, GizmoSpace space, GizmoPart hovered) {
    if (!allFinite(place.at)) return;
    const Eigen::Matrix4d view = scene.camera.view();
    auto look = std::make_shared<render::GizmoLook>();
    look->axes = gizmoAxes(space, place.local, -view.block<1, 3>(2, 0).transpose(), view.block<1, 3>(0, 0).transpose());
    look->turns = place.turns;
    look->scales = place.scales;
    look->moves = place.moves;
    look->hovered = hovered;
    render::Marker marker;
    marker.shape = render::Marker::Shape::Gizmo;
    marker.from = marker.to = place.at;
    marker.gizmo = std::move(look);
    scene.markers.push_back(std::move(marker));
}

QString gizmoHint(GizmoPart part) {
    const QString keys = QStringLiteral(" · ") + ToolTexts::tr("Type a number · Shift: fine · Ctrl: snap · Esc: cancel");
    if (part == GizmoPart::None) return {};
    if (part == GizmoPart::Middle) return ToolTexts::tr("Drag: move freely") + keys;
    if (part == GizmoPart::RingView) return ToolTexts::tr("Drag: turn about the view") + keys;
    const auto name = [&](GizmoPart first) { return QString(QLatin1Char(char('X' + int(part) - int(first)))); };
    if (render::isOneOf(part, GizmoPart::AxisX)) return ToolTexts::tr("Drag: move along %1").arg(name(GizmoPart::AxisX)) + keys;
    if (render::isOneOf(part, GizmoPart::PlaneX)) return ToolTexts::tr("Drag: move across %1").arg(name(GizmoPart::PlaneX)) + keys;
    if (render::isOneOf(part, GizmoPart::RingX)) return ToolTexts::tr("Drag: turn about %1").arg(name(GizmoPart::RingX)) + keys;
    return ToolTexts::tr("Drag: scale along %1").arg(name(GizmoPart::ScaleX)) + keys;
}

}  // namespace imomushi
