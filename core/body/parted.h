// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Parts places where a closed surface touches itself, which no solver takes: vertices that lie on a triangle elsewhere, up to rounding, move a little back to their own side, by at
/// most twice kParted of their shortest edge. Returns the vertices that moved, ascending.
std::vector<std::int32_t> partTouching(TriangleMesh& mesh);
inline constexpr double kParted = 1e-3;

}  // namespace imomushi
