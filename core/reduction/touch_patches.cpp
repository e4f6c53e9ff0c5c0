// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/touch_patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "core/mesh/connectivity.h"
#include "core/mesh/surface_distance.h"
#include "core/mesh/topology.h"
#include "core/meshing/mesh_pieces.h"

namespace imomushi {
namespace {

constexpr double kFar = SurfaceDistance::kFar;
/// Bumps reach this many times as far as the farthest place is from its nearest centre: four or five overlap, and where the most distant two meet
/// both still have half of their height.
constexpr double kOverlap = 1.8;
/// Fewer vertices to a bump would make it as pointed as a single one.
constexpr std::size_t kVerticesPerPatch = 4;

}  // namespace

std::vector<char> touchableTriangles(const TriangleMesh& mesh, const EdgeTable& edges, std::span<const std::int32_t> held) {
    int count = 0;
    const std::vector<std::int32_t> component = edgeComponents(mesh.triangles, edges, count);
    const Vec3 origin = mesh.vertices.colwise().mean().transpose();
    std::vector<double> volume(static_cast<std::size_t>(count));
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        volume[static_cast<std::size_t>(component[static_cast<std::size_t>(f)])] +=
            areaVector(mesh, f).dot(Vec3(mesh.vertices.row(mesh.triangles(f, 0)).transpose()) - origin);
    std::vector<char> out(static_cast<std::size_t>(mesh.triangles.rows()));
    for (std::size_t f = 0; f < out.size(); ++f) out[f] = volume[static_cast<std::size_t>(component[f])] > 0.0;
    for (const std::int32_t f : held) out[static_cast<std::size_t>(f)] = 0;
    return out;
}

Eigen::MatrixXd TouchPatches::dense() const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(first.size()) - 1, count());
    for (std::size_t v = 0; v + 1 < first.size(); ++v)
        for (auto i = static_cast<std::size_t>(first[v]); i < static_cast<std::size_t>(first[v + 1]); ++i)
            out(static_cast<Eigen::Index>(v), patch[i]) = weight[i];
    return out;
}

TouchPatches touchPatches(const ElementMesh& element, std::span<const JointFace> faces, int count) {
    const TriangleMesh& body = element.body;
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());
    TouchPatches out;
    out.first.assign(vertices + 1, 0);
    if (faces.empty() || count <= 0) return out;
    std::vector<std::int32_t> held;
    for (const JointFace& face : faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
    const std::vector<char> touchable = touchableTriangles(body, element.connectivity().edges(), held);
    SurfaceDistance surface(body, touchable);
    std::vector<double> nearest(vertices, -1.0);  // of the centres; -1: cannot be touched
    std::size_t reachable = 0;
    for (std::size_t v = 0; v < vertices; ++v)
        if (surface.has(v)) {
            nearest[v] = kFar;
            ++reachable;
        }
    const std::size_t most = std::clamp<std::size_t>(reachable / kVerticesPerPatch, 1, static_cast<std::size_t>(count));
    // The farthest vertex; of equally far ones the first.
    const auto farthest = [&] {
        std::size_t at = 0;
        for (std::size_t v = 1; v < vertices; ++v)
            if (nearest[v] > (1.0 + kTie) * nearest[at] || (nearest[at] <= 0.0 && nearest[v] > nearest[at])) at = v;
        return at;
    };
    for (std::size_t next = farthest(); nearest[next] > 0.0 && (out.centre.size() < most || nearest[next] == kFar); next = farthest()) {
        out.centre.push_back(static_cast<std::int32_t>(next));
        surface.spread(
            static_cast<std::int32_t>(next), kFar, [&](std::int32_t v, double d) { return d < nearest[static_cast<std::size_t>(v)]; },
            [&](std::int32_t v, double d) { nearest[static_cast<std::size_t>(v)] = std::min(nearest[static_cast<std::size_t>(v)], d); });
    }
    const double radius = nearest[farthest()];
    if (out.centre.empty()) return out;

    out.reach = kOverlap * radius;
    std::vector<std::vector<std::pair<std::int32_t, double>>> bumps(vertices);
    std::vector<double> sum(vertices);
    for (std::int32_t p = 0; p < out.count(); ++p) {
        const std::int32_t centre = out.centre[static_cast<std::size_t>(p)];
        // Where every vertex is a centre, each is a bump.
        surface.spread(
            centre, out.reach > 0.0 ? out.reach : std::numeric_limits<double>::min(), [](std::int32_t, double) { return true; },
            [&](std::int32_t v, double d) {
                const double t = out.reach > 0.0 ? d / out.reach : 0.0, bump = (1.0 - t * t) * (1.0 - t * t);
                bumps[static_cast<std::size_t>(v)].emplace_back(p, bump);
                sum[static_cast<std::size_t>(v)] += bump;
            });
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        for (const auto& [p, bump] : bumps[v]) {
            out.patch.push_back(p);
            out.weight.push_back(static_cast<float>(bump / sum[v]));
        }
        out.first[v + 1] = static_cast<std::int32_t>(out.patch.size());
    }
    return out;
}

}  // namespace imomushi
