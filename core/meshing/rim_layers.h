// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/meshing/solver_mesh.h"

namespace imomushi {

/// Cuts the triangles at singular edges into `layers` strips along the edge, 1...8, the thinner the nearer (the i-th ends at (i / layers)^3 of the
/// way). The solution varies strongly across such an edge but smoothly along it: long thin triangles therefore resolve it with far
/// fewer vertices than refining in both directions. Singular are the rims of faces where the body fills more than kMixedAngle, and free edges where
/// it fills more than kReentrantAngle. Edges beside a triangle that is thin already keep it as it is.
/// No vertex is moved; new ones come last. Deterministic.
SolverMesh withLayers(const SolverMesh& mesh, int layers);

/// A mixed condition is regular below about this inner angle (radians): 60 degrees.
inline constexpr double kMixedAngle = 1.0471975511965976;
/// A free edge of this inner angle has a solution like r^0.68 (225 degrees); flatter ones are left alone: they also stem from
/// smooth concave surfaces drawn with triangles.
inline constexpr double kReentrantAngle = 3.839724354387525;  // 220 degrees

}  // namespace imomushi
