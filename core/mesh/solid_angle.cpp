// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/solid_angle.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace imomushi {

double edgeBend(const TriangleMesh& mesh, std::span<const EdgeUse> uses) {
    const EdgeUse& left = uses[0].forward ? uses[0] : uses[1];
    const EdgeUse& right = uses[0].forward ? uses[1] : uses[0];
    const Vec3 along = (mesh.vertices.row(left.high) - mesh.vertices.row(left.low)).transpose();
    const Vec3 n = areaVector(mesh, left.triangle).normalized(), m = areaVector(mesh, right.triangle).normalized();
    return std::atan2(n.cross(m).dot(along.normalized()), n.dot(m));
}

std::vector<double> vertexSolidAngles(const TriangleMesh& mesh) {
    // The triangles around a vertex cut a polygon out of a sphere; its area is 2 pi less the sum of its outer angles (Gauss-Bonnet), and
    // these are the angles between neighbouring normals, positive across convex edges.
    std::vector<double> bend(static_cast<std::size_t>(mesh.vertices.rows()), 0.0);
    const EdgeTable edges(mesh.triangles);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2) continue;
        const double angle = edgeBend(mesh, uses);
        bend[static_cast<std::size_t>(uses[0].low)] += angle;
        bend[static_cast<std::size_t>(uses[0].high)] += angle;
    }
    for (double& b : bend) b = (2.0 * std::numbers::pi - b) / (4.0 * std::numbers::pi);
    return bend;
}

}  // namespace imomushi
