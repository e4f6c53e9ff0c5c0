// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/inner_angle.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace imomushi {

double innerSolidAngle(const TriangleMesh& mesh, std::int32_t vertex, std::span<const std::int32_t> triangles) {
    // The cone of inner directions is bounded by the edges opposite to the vertex; spherical triangles between them and any one direction add up to it.
    const Vec3 x = mesh.vertices.row(vertex).transpose();
    Vec3 inwards = Vec3::Zero();
    std::vector<std::pair<Vec3, Vec3>> edges;
    for (const std::int32_t f : triangles)
        for (int c = 0; c < 3; ++c)
            if (mesh.triangles(f, c) == vertex) {
                const Vec3 a = (Vec3(mesh.vertices.row(mesh.triangles(f, (c + 1) % 3)).transpose()) - x).normalized();
                const Vec3 b = (Vec3(mesh.vertices.row(mesh.triangles(f, (c + 2) % 3)).transpose()) - x).normalized();
                inwards -= a.cross(b).normalized();
                edges.emplace_back(a, b);
            }
    // Off every symmetry, so that no edge lies opposite to it.
    inwards = (inwards.normalized() + Vec3(0.0123, 0.0231, -0.0312)).normalized();
    double sum = 0.0;
    for (const auto& [a, b] : edges)
        sum += 2.0 * std::atan2(inwards.dot(b.cross(a)), 1.0 + inwards.dot(a) + inwards.dot(b) + a.dot(b));
    const double share = sum / (4.0 * std::numbers::pi);
    return share - std::floor(share);
}

double innerAngle(const TriangleMesh& mesh, std::span<const EdgeUse> uses) {
    const EdgeUse& a = uses[0];
    const EdgeUse& b = uses[1];
    const Vec3 low = mesh.vertices.row(a.low).transpose();
    const Vec3 n = areaVector(mesh, a.triangle).normalized(), m = areaVector(mesh, b.triangle).normalized();
    const Vec3 across = Vec3(mesh.vertices.row(mesh.triangles(b.triangle, (b.corner + 2) % 3)).transpose()) - low;
    const double turn = std::atan2(n.cross(m).norm(), n.dot(m));  // 0: flat
    return 0.5 + (across.dot(n) > 0.0 ? turn : -turn) / (2.0 * std::numbers::pi);
}

}  // namespace imomushi
