// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/parted.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

std::vector<std::int32_t> partTouching(TriangleMesh& mesh) {
    const VertexCorners corners(mesh);
    const TriangleTree tree(mesh);
    const auto place = [&](std::int32_t v) -> Vec3 { return mesh.vertices.row(v).transpose(); };
    std::vector<std::pair<std::int32_t, Vec3>> moves;
    std::vector<std::int32_t> ring;
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(corners.vertices()); ++v) {
        ring.assign(1, v);
        double shortest = std::numeric_limits<double>::infinity();
        Vec3 around = Vec3::Zero();
        for (const std::int32_t corner : corners.at(v))
            for (int k = 1; k < 3; ++k) {
                ring.push_back(mesh.triangles(corner / 3, (corner + k) % 3));
                shortest = std::min(shortest, (place(ring.back()) - place(v)).norm());
                around += place(ring.back());
            }
        if (ring.size() == 1) continue;
        around /= static_cast<double>(ring.size() - 1);
        const double least = kParted * shortest;
        std::vector<std::int32_t> near;
        for (const std::int32_t f : tree.within(place(v), least))
            if (std::ranges::none_of(mesh.triangles.row(f), [&](std::int32_t w) { return std::ranges::find(ring, w) != ring.end(); })) near.push_back(f);
        if (near.empty()) continue;
        const auto hit = TriangleTree(mesh, near).nearest(place(v));
        if (!(hit.squaredDistance < least * least)) continue;
        const Vec3 normal = areaVector(mesh, hit.triangle).normalized();
        const Vec3 there = place(mesh.triangles(hit.triangle, 0));
        const double side = normal.dot(around - there) < 0.0 ? -1.0 : 1.0;
        moves.emplace_back(v, place(v) + (side * least - normal.dot(place(v) - there)) * normal);
    }
    std::vector<std::int32_t> moved;
    for (const auto& [v, to] : moves) {
        mesh.vertices.row(v) = to.transpose();
        moved.push_back(v);
    }
    return moved;
}

}  // namespace imomushi
