// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Moves vertices of a closed surface that touch its triangles elsewhere, or lie in them but for rounding, a little back to their own side: what encloses such a place has no clear inside,
/// and no solver takes it. They move by at most twice kParted of their shortest edge. Vertices that were moved, ascending.
std::vector<std::int32_t> partTouching(TriangleMesh& mesh);
inline constexpr double kParted = 1e-3;

}  // namespace imomushi
