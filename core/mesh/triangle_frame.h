// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "core/mesh/mesh.h"

namespace imomushi {

/// What gradients of linear functions on a triangle need.
struct TriangleFrame {
    std::array<Vec3, 3> slope;  ///< gradient along the surface of the linear function that is 1 at a corner and 0 at the others
    Vec3 normal = Vec3::Zero();
    double area = 0.0;          ///< 0: it has none, and no slopes
};

inline TriangleFrame triangleFrame(const TriangleMesh& mesh, std::int32_t f) {
    TriangleFrame out;
    std::array<Vec3, 3> p;
    for (std::size_t c = 0; c < 3; ++c) p[c] = mesh.vertices.row(mesh.triangles(f, static_cast<Eigen::Index>(c))).transpose();
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    const double length = cross.norm();
    if (!(length > 0.0)) return out;
    out.normal = cross / length;
    out.area = 0.5 * length;
    for (std::size_t c = 0; c < 3; ++c) out.slope[c] = out.normal.cross(p[(c + 2) % 3] - p[(c + 1) % 3]) / length;
    return out;
}

}  // namespace imomushi
