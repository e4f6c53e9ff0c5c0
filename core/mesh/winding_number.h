// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/mesh.h"

namespace imomushi {

/// How often the surface winds around `point`: 1 inside a closed surface that faces outward, 0 outside, -1 inside one that faces inward.
/// The sum of the solid angles of its triangles (van Oosterom and Strackee 1983) over 4 pi.
double windingNumber(const TriangleMesh& mesh, const Vec3& point);
/// The same of some triangles of a mesh.
double windingNumber(const TriangleMesh& mesh, std::span<const std::int32_t> triangles, const Vec3& point);

}  // namespace imomushi
