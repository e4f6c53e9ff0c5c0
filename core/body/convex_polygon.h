// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Triangles (as indices of points, wound like the polygon) of a plane polygon that is convex, points in line allowed. The smallest of their angles is as
/// large as it can be without more points. Dynamic programming over diagonals, O(n^3).
std::vector<std::array<std::int32_t, 3>> triangulateConvex(const std::vector<Vec3>& polygon);

}  // namespace imomushi
