// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Writes positions and triangles as Wavefront OBJ (shortest decimals that read back as the same doubles) or PLY (binary, little-endian,
/// double), chosen by the suffix .obj or .ply. Order, axes and unit stay. The file appears whole or not at all.
/// Errors: "unknown-format", "bad-value" (a coordinate is not finite), "bad-index", "not-writable".
Result<void> writeMesh(const std::filesystem::path& path, const Points& vertices, const Triangles& triangles);

}  // namespace imomushi
