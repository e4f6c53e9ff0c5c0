// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The rim of a patch of triangles as closed loops of vertices.
std::vector<std::vector<std::int32_t>> rimLoops(const Triangles& triangles, std::span<const std::int32_t> patch);

}  // namespace imomushi
