// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"

namespace imomushi {

/// A surface that was checked.
struct HeldSurface {
    std::vector<int> patchOf;  ///< the patch that holds each vertex, -1: none
    EdgeTable edges;
};
/// Checks mesh, patches and numbers of a boundary problem. Errors: those of BoundaryProblem::build() that need no integrals.
Result<HeldSurface> heldSurface(const BoundaryProblem::Input& input);

/// Whether a separate part of the body has no held vertex. Shells that point inwards are cavities of another part.
bool hasUnheldPart(const TriangleMesh& mesh, const HeldSurface& surface);

}  // namespace imomushi
