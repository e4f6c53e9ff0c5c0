// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/flat_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

namespace imomushi {

namespace {

/// Of the whole area: the largest planes of 19 elements have 3.9 % and more, those of eight creatures 0.7 % and less; a control cage of 5.7 % is mistaken.
constexpr double kFlatShare = 0.015;
/// Planes are the same to these: of the components of their normals, and of the diagonal.
constexpr double kSameNormal = 1.0 / 200.0, kSamePlane = 1e-3;

}  // namespace

bool hasFlatRegion(const TriangleMesh& mesh) {
    if (mesh.vertices.rows() == 0) return false;
    const Vec3 low = mesh.vertices.colwise().minCoeff(), high = mesh.vertices.colwise().maxCoeff();
    const double step = kSamePlane * (high - low).norm();
    if (!(step > 0.0)) return false;
    std::map<std::array<std::int64_t, 4>, double> areaOfPlane;
    double whole = 0.0, largest = 0.0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto corner = [&](int k) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, k)).transpose(); };
        const Vec3 a = corner(0), across = 0.5 * (corner(1) - a).cross(corner(2) - a);
        const double area = across.norm();
        whole += area;
        if (!(area > 0.0)) continue;
        const Vec3 normal = across / area;
        std::array<std::int64_t, 4> plane{};
        for (std::size_t k = 0; k < 3; ++k) plane[k] = std::llround(normal[static_cast<Eigen::Index>(k)] / kSameNormal);
        plane[3] = std::llround(normal.dot(a - low) / step);
        largest = std::max(largest, areaOfPlane[plane] += area);
    }
    return largest > kFlatShare * whole;
}

}  // namespace imomushi
