// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "core/mesh/mesh.h"

namespace imomushi {

/// A closed mesh with triangles of about equal sides, as many as `vertices` vertices take. Of the same topology, some way off the surface where that is finer.
/// Empty: it cannot be remeshed (it is not manifold).
TriangleMesh evenMesh(const TriangleMesh& mesh, std::size_t vertices);

}  // namespace imomushi
