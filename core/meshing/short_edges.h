// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/meshing/solver_mesh.h"

namespace imomushi {

/// Collapses edges that are far shorter than those around both of their ends. Where a long narrow triangle ends in a point, bisection halves its short side again and again, down to a size at which
/// TetGen does not end. Only vertices with an `origin` go, each into a neighbour that is much nearer than its other ones; those at rims
/// of faces along the rim. What is left keeps its order; its origins lie between vertices without one. Deterministic.
SolverMesh withoutShortEdges(const SolverMesh& mesh);

}  // namespace imomushi
