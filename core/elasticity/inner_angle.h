// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/topology.h"

namespace imomushi {

/// The part of the full solid angle that the body fills as seen from a vertex: the free term of the boundary equation at that vertex, equal to
/// minus the sum of D_a over the whole surface / (4 pi), but found from the triangles around the vertex alone. `triangles`: all that touch it.
double innerSolidAngle(const TriangleMesh& mesh, std::int32_t vertex, std::span<const std::int32_t> triangles);

/// The same as seen from the inside of an edge between two triangles: its inner dihedral angle / (2 pi), in (0, 1).
double innerAngle(const TriangleMesh& mesh, std::span<const EdgeUse> uses);

}  // namespace imomushi
