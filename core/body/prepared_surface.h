// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/health.h"
#include "core/mesh/mend_surface.h"
#include "core/mesh/mesh.h"

// Of makeBody() and examineSurface() alone.
namespace imomushi {

/// A render mesh after all mending that needs no choice between its parts: welded, separated where it was not manifold, evenly wound, its holes closed.
struct PreparedSurface {
    TriangleMesh mesh;                     ///< every vertex is used
    std::vector<std::int32_t> vertexOf;    ///< per render vertex the vertex of `mesh` that it became, -1: none
    bool sameShape = true;                 ///< no triangle with an area was dropped or added, and none was separated from another
    std::vector<MeshIssue> issues;         ///< what was mended
};

/// Whether triangles can be computed with. `part`: #F or empty. Errors: "empty-mesh", "bad-index", "non-finite" (a vertex in use).
Result<void> checkTriangles(const TriangleMesh& mesh, std::span<const std::int32_t> part);

/// The same triangles as a surface to mend; vertices that none uses become zero.
RawSurface rawSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part);

/// `render`: indices in range and used vertices finite; `part`: #F or empty.
PreparedSurface prepareSurface(const TriangleMesh& render, std::span<const std::int32_t> part);

/// Pairs the triangles at edges that have more than two, so that each pair bounds flesh, and gives every fan of triangles around a vertex a vertex of its own. Triangles
/// that hang on such an edge by one side, with nothing on another, and walls that divide flesh are dropped where they are few. Returns whether anything changed.
bool separateNonManifold(MendSurface& s);

/// Winds neighbours alike, turns surfaces outward and cavities inward.
void orientSurface(MendSurface& s);

/// Closes the holes that capHoles() leaves, which wants all of a surface to be closed and no new vertices: each by itself, around a new vertex where it must be.
/// New faces have no render vertices (-1). For a surface that is manifold but for its holes.
void closeHoles(MendSurface& s);

}  // namespace imomushi
