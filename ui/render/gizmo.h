// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace imomushi::render {

/// What can be taken hold of: axes, the planes across them, rings about them and about the view, ends of axes that scale, the middle.
enum class GizmoPart { None, AxisX, AxisY, AxisZ, PlaneX, PlaneY, PlaneZ, RingX, RingY, RingZ, RingView, ScaleX, ScaleY, ScaleZ, Middle };

/// The part of an axis 0, 1, 2.
inline GizmoPart partOf(GizmoPart x, int axis) { return GizmoPart(int(x) + axis); }
/// Whether `part` is one of the three that begin with `x`.
inline bool isOneOf(GizmoPart part, GizmoPart x) { return int(part) >= int(x) && int(part) < int(x) + 3; }

/// A gizmo: three axes, three planes, rings and a middle, as large everywhere.
struct GizmoLook {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns, unit
    bool turns = false, scales = false, moves = true;
    GizmoPart hovered = GizmoPart::None;
};

/// Distances from its middle, pixels of the design.
struct GizmoSizes {
    static constexpr double kStem = 13.0, kNeck = 72.0, kTip = 88.0, kPlaneFrom = 22.0, kPlaneTo = 38.0, kRing = 62.0, kScale = 99.0, kBox = 4.5, kRingView = 114.0, kReach = 122.0;
    static constexpr int kSides = 96;
};

/// 0: seen so nearly end on (an axis) or from its edge (a plane, a ring) that it cannot be taken; 1: well seen. sine: of the angle between the view and the axis, or the plane.
inline double gizmoFade(double sine) {
    constexpr double kGone = 0.105, kWhole = 0.26;  // 6 and 15 degrees
    return std::clamp((sine - kGone) / (kWhole - kGone), 0.0, 1.0);
}
/// Of an axis, `view`: unit, from the eye.
inline double axisFade(const Eigen::Vector3d& axis, const Eigen::Vector3d& view) { return gizmoFade(axis.cross(view).norm()); }
inline double planeFade(const Eigen::Vector3d& normal, const Eigen::Vector3d& view) { return gizmoFade(std::abs(normal.dot(view))); }

/// The corners of the plane across axis k, relative to the middle, pixels of the design: on the side of the viewer.
inline std::array<Eigen::Vector3d, 4> gizmoPlane(const Eigen::Matrix3d& axes, int k, const Eigen::Vector3d& view) {
    const auto toViewer = [&](int i) -> Eigen::Vector3d { return axes.col(i).dot(view) > 1e-6 ? Eigen::Vector3d(-axes.col(i)) : Eigen::Vector3d(axes.col(i)); };
    const Eigen::Vector3d a = toViewer((k + 1) % 3), b = toViewer((k + 2) % 3);
    constexpr double kFrom = GizmoSizes::kPlaneFrom, kTo = GizmoSizes::kPlaneTo;
    return {kFrom * a + kFrom * b, kTo * a + kFrom * b, kTo * a + kTo * b, kFrom * a + kTo * b};
}

}  // namespace imomushi::render
