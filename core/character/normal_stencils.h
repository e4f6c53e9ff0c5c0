// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/character/vertex_kernels.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// One stencil per vertex (padded to a multiple of kVertexBlock) that gives the area-weighted normal of its triangles: exactly at rest and after
/// affine motions, and nearly so after motions that are nearly affine over a ring of triangles (tests/bench/engine.cpp measures how nearly).
/// triangles: 3 rows of `vertices` each; vertices of none get a stencil without area. scale: see findNormals().
std::vector<NormalStencil> normalStencils(const Points& vertices, const std::vector<std::int32_t>& triangles, double scale);

}  // namespace imomushi
