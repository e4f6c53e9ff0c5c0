// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

// Sets of vertices that become joint faces.

namespace imomushi {

/// The triangles of which all corners are among `vertices`, ascending.
std::vector<std::int32_t> trianglesWithin(const TriangleMesh& body, std::span<const std::int32_t> vertices);

/// `vertices` of a body with so many rings of neighbours, or, of fewer than 0, without so many of their outer rings; then without those that are no corner of
/// trianglesWithin() them. Ascending.
std::vector<std::int32_t> grownVertices(const TriangleMesh& body, std::span<const std::int32_t> vertices, int rings);

}  // namespace imomushi
