// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The triangles of a mesh in clusters that lie close together, by their place at rest (Morton order). A ray that asks where it meets the mesh in some pose looks
/// at the box of each cluster in that pose, and only in those that it meets at triangles: flesh that moves keeps clusters together, and nothing is kept for a pose.
class TriangleClusters {
public:
    static constexpr std::size_t kTriangles = 64;  ///< of a cluster, at most

    explicit TriangleClusters(const TriangleMesh& mesh);

    /// Calls visit(low, high, triangles) for each cluster in its order, with its box by where vertices are now, m, until it answers false. at(vertex): a vector of floats or doubles;
    /// at.wide(vertex), where there is one: the same as an array of four floats of which the last is anything, which a processor reads at once.
    template <class At, class Visit>
    void forEach(const At& at, const Visit& visit) const {
        for (std::size_t c = 0; c + 1 < firstVertex_.size(); ++c) {
            const auto vertices = std::span(vertices_).subspan(firstVertex_[c], firstVertex_[c + 1] - firstVertex_[c]);
            const auto box = [&](const auto& place) {
                auto low = place(vertices[0]), high = low;
                for (const std::int32_t v : vertices) {
                    const auto p = place(v);
                    low = low.cwiseMin(p);
                    high = high.cwiseMax(p);
                }
                return std::pair<Vec3, Vec3>(low.template head<3>().template cast<double>(), high.template head<3>().template cast<double>());
            };
            const auto [low, high] = [&] {
                if constexpr (requires { at.wide(vertices[0]); }) return box([&](std::int32_t v) { return at.wide(v); });
                else return box(at);
            }();
            if (!visit(low, high, std::span(triangles_).subspan(c * kTriangles, std::min(kTriangles, triangles_.size() - c * kTriangles)))) return;
        }
    }

    /// Triangles that a ray may meet, ascending, and others; `at`: as above. Those that it meets by exact arithmetic are among them.
    template <class At>
    void along(const Vec3& origin, const Vec3& direction, const At& at, std::vector<std::int32_t>& out) const {
        out.clear();
        forEach(at, [&](const Vec3& low, const Vec3& high, std::span<const std::int32_t> triangles) {
            if (meets(origin, direction, low, high)) out.insert(out.end(), triangles.begin(), triangles.end());
            return true;
        });
        std::sort(out.begin(), out.end());
    }

private:
    static bool meets(const Vec3& origin, const Vec3& direction, const Vec3& low, const Vec3& high);

    std::vector<std::int32_t> triangles_;  // cluster after cluster
    std::vector<std::int32_t> vertices_;   // of the clusters, each once in each
    std::vector<std::size_t> firstVertex_;
};

}  // namespace imomushi
