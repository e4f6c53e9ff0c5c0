// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Checks mesh, patches and numbers of a boundary problem. Returns the patch that holds each vertex, -1: none. Errors: those of BoundaryProblem::build()
/// that need no integrals.
Result<std::vector<int>> patchOfVertices(const BoundaryProblem::Input& input);

/// Whether a separate part of the body has no held vertex (patchOf >= 0). Shells that point inwards are cavities of another part.
bool hasUnheldPart(const TriangleMesh& mesh, const std::vector<int>& patchOf);

}  // namespace imomushi
