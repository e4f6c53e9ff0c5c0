// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Whether the surfaces of two meshes touch.
bool surfacesMeet(const TriangleMesh& a, const TriangleMesh& b);

/// The union of two closed, outward bodies, whether their surfaces meet or not; vertices of both that lie on it keep their coordinates. None where a surface crosses itself or
/// the two cannot be told apart there. May hold triangles without area; where triangles of both lie on each other, it may touch itself in edges and vertices.
std::optional<TriangleMesh> unite(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace imomushi
