// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/triangle_mesh.h"

namespace imomushi {

/// Triangles over a closed polygon in space, without new vertices: corners are indices into `polygon` (#N x 3, N >= 3), wound as the
/// polygon runs. Flat polygons, concave ones too, are triangulated in their plane; others with small dihedral angles and little area
/// (Liepa 2003). Empty where there is none.
std::vector<std::array<std::int32_t, 3>> triangulateHole(const Points& polygon);

}  // namespace imomushi
