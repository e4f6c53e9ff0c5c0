// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/mesh/topology.h"

namespace imomushi {

/// How far the surface turns across an edge of two triangles: the angle between their normals in (-pi, pi], positive where the edge is convex.
/// The angle inside of the body is pi less this.
double edgeBend(const TriangleMesh& mesh, std::span<const EdgeUse> uses);

/// Per vertex: the part of a full sphere around it that lies inside the body, by the triangles around that vertex alone (1/2 on a smooth
/// surface, 1/8 at the corner of a cube). In range where the surface is closed, evenly wound and manifold there; any number elsewhere.
/// The winding number at the vertex, which counts all triangles, is the same unless the surface passes through the vertex once more or
/// overlaps itself there: that is how a body is known that touches itself. Rounding: 1e-15 over the flatness of the triangles.
std::vector<double> vertexSolidAngles(const TriangleMesh& mesh);

}  // namespace imomushi
