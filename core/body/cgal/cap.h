// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// A plane region with its triangles. Points: those of the loops, one loop after another, then `added`.
struct PlaneRegion {
    std::vector<Eigen::Vector2d> added;
    std::vector<std::vector<std::int32_t>>
        onSide;                  ///< per side of a loop (it begins at the point of the same number): the added points on it, in its direction
    Triangles triangles;         ///< counter-clockwise
    double smallestAngle = 0.0;  ///< of the triangles, radians
};

/// Meshes the region between closed loops (each of at least three points, no two at the same place; the first is the outer one, the others
/// are holes in it) by constrained Delaunay triangles: points are added, inside and on the loops, until sides are at most 1.5 `spacing` long (longer in the
/// middle of wide regions) and angles at least 15 degrees, except at corners and necks of the loops that are sharper. None: the loops touch or cross.
std::optional<PlaneRegion> meshRegion(const std::vector<std::vector<Eigen::Vector2d>>& loops, double spacing);

}  // namespace imomushi
