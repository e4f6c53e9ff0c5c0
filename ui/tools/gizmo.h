// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/gizmo.h"
#include "ui/tools/axis_lock.h"
#include "ui/tools/tool.h"

namespace imomushi {

/// Where the gizmo stands, and what it may do there.
struct GizmoPlace {
    Vec3 at = Vec3::Zero();                                  ///< m, world
    Eigen::Matrix3d local = Eigen::Matrix3d::Identity();     ///< columns: axes of what is selected, unit
    bool turns = false, scales = false;
    bool moves = true;
};
/// With these parts alone; all of them where it has none of these.
[[nodiscard]] GizmoPlace withParts(GizmoPlace place, GizmoParts parts);

/// The axes in which things are dragged. `forward`, `right`: of the view.
Eigen::Matrix3d gizmoAxes(GizmoSpace space, const Eigen::Matrix3d& local, const Vec3& forward, const Vec3& right);
/// Those of a bone as it is shown: the first one along it, the second as nearly upright as it can be. Of what is no bone, those of the world.
Eigen::Matrix3d axesOfBone(const Session& session, PartId bone);

/// What of it is under the pointer. What is seen end on, or from its edge, cannot be taken.
render::GizmoPart gizmoUnder(const PointerEvent& e, const GizmoPlace& place, GizmoSpace space);
[[nodiscard]] bool turnsBy(render::GizmoPart part);
/// Confines a drag to the axis or the plane of the part.
void lockTo(AxisLock& lock, render::GizmoPart part);
void addGizmo(render::Scene& scene, const GizmoPlace& place, GizmoSpace space, render::GizmoPart hovered);
/// What a press on the part does, translated; empty: nothing.
QString gizmoHint(render::GizmoPart part);

}  // namespace imomushi
