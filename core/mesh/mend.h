// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/health.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A surface as a file gave it: nothing is promised but indices in range and finite positions of used vertices.
struct RawSurface {
    /// body: positions in the order of the file and all triangles. renderMesh: render vertices with `bodyVertex` into body's vertices; one without
    /// `triangles` has no attributes (its materials and RenderMesh::material count nevertheless).
    ElementMesh mesh;
    std::vector<std::int32_t> part;  ///< #F: the object of the file that a triangle belongs to
};

struct MendedBody {
    ElementMesh mesh;               ///< every vertex is used; they keep the order of the file
    std::int32_t part = 0;          ///< of its first triangle
    std::vector<MeshIssue> issues;  ///< what is left after mending (checkMesh)
    int components = 1;
    bool closed = false;            ///< closed, manifold, outward, nothing of severity Error left
};

struct MendResult {
    std::vector<MendedBody> bodies;
    std::vector<MeshIssue> mended;  ///< what was found and mended (fixed = true), or cannot be (non-orientable), over all bodies
};

/// Makes elements of a surface as far as that needs no guess: welds seams, drops unused vertices, degenerate and duplicate triangles, makes the
/// winding consistent, caps holes, turns shells outward and the cavities in them inward.
/// Only vertices at open edges are welded, to the lowest index: what is closed stays as it is, even where it touches itself.
/// split: one body per connected surface; a cavity stays with the shell around it.
MendResult mend(RawSurface surface, bool split);

}  // namespace imomushi
