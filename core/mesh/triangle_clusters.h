// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The triangles of a mesh in clusters that lie close together, by their place at rest (Morton order). A ray that asks where it meets the mesh in some pose looks
/// at the box of each cluster in that pose, and only in those that it meets at triangles: flesh that moves keeps clusters together, and nothing is kept for a pose.
class TriangleClusters {
public:
    static constexpr std::size_t kTriangles = 64;  ///< of a cluster, at most

    explicit TriangleClusters(const TriangleMesh& mesh);

    /// Triangles that a ray may meet, ascending, and others; `at`: where a vertex is now, m. Those that it meets by exact arithmetic are among them.
    template <class At>
    void along(const Vec3& origin, const Vec3& direction, const At& at, std::vector<std::int32_t>& out) const {
        out.clear();
        for (std::size_t c = 0; c + 1 < firstVertex_.size(); ++c) {
            const auto vertices = std::span(vertices_).subspan(firstVertex_[c], firstVertex_[c + 1] - firstVertex_[c]);
            Vec3 low = at(vertices[0]), high = low;
            for (const std::int32_t v : vertices) {
                const Vec3 p = at(v);
                low = low.cwiseMin(p);
                high = high.cwiseMax(p);
            }
            if (meets(origin, direction, low, high)) out.insert(out.end(), triangles_.begin() + first(c), triangles_.begin() + first(c + 1));
        }
        std::sort(out.begin(), out.end());
    }

private:
    [[nodiscard]] std::ptrdiff_t first(std::size_t cluster) const { return static_cast<std::ptrdiff_t>(std::min(cluster * kTriangles, triangles_.size())); }
    static bool meets(const Vec3& origin, const Vec3& direction, const Vec3& low, const Vec3& high);

    std::vector<std::int32_t> triangles_;  // cluster after cluster
    std::vector<std::int32_t> vertices_;   // of the clusters, each once in each
    std::vector<std::size_t> firstVertex_;
};

}  // namespace imomushi
