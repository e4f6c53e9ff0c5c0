// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// All triangles, those that lie close together one after the other (Morton order of their middles).
std::vector<std::int32_t> trianglesByPlace(const TriangleMesh& mesh);

}  // namespace imomushi
