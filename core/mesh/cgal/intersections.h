// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/triangle_mesh.h"

namespace imomushi {

/// Pairs of triangles that meet anywhere else than in the vertices and edges they share by index, found with exact predicates.
/// Needs no manifold mesh; indices must be in range and coordinates finite. Triangles without area are left out.
/// Ends early after `limit` pairs, or with those found so far when cancelled. Ascending, so that the answer is the same on every machine.
std::vector<std::pair<std::int32_t, std::int32_t>> selfIntersections(const TriangleMesh& mesh, std::size_t limit,
                                                                     const Progress& progress = {});

}  // namespace imomushi
