// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "core/base/progress.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A closed mesh coarsened to about `vertices` vertices: edges collapse in the order of what the surface loses (Lindstrom and Turk 1998, which keeps
/// the volume). May cross itself where two walls are near each other. As it was where cancelled or where it has no more vertices than that.
TriangleMesh collapseEdges(const TriangleMesh& mesh, std::size_t vertices, const Progress& progress);

}  // namespace imomushi
