// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/body/cut.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A place mirrored by a plane with a unit normal.
inline Vec3 mirroredPoint(const CutPlane& plane, const Vec3& p) { return p - 2.0 * plane.normal.dot(p - plane.origin) * plane.normal; }
inline Vec3 mirroredDirection(const CutPlane& plane, const Vec3& d) { return d - 2.0 * plane.normal.dot(d) * plane.normal; }
/// The nearest place on it.
inline Vec3 ontoPlane(const CutPlane& plane, const Vec3& p) { return p - plane.normal.dot(p - plane.origin) * plane.normal; }

/// The plane that mirrors a surface onto itself: mirrored vertices lie on average (root mean square) at most kMirrorTolerance diagonals off it. Of several the one
/// whose normal is nearest to x, then z, as characters look along z; planes that mirror up and down (y) come last. The normal is unit, its largest coordinate
/// positive. Planes that lie within rounding of the world's axes are made parallel to them.
std::optional<CutPlane> findMirrorPlane(const TriangleMesh& mesh);

inline constexpr double kMirrorTolerance = 0.008;

}  // namespace imomushi
