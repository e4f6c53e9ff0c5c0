// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

/// A vertex and how far it is from a source on the surface, m.
using SurfaceSource = std::pair<std::int32_t, double>;

/// Distances along some of the triangles of a mesh, unfolded triangle by triangle (Novotni and Klein, Computing geodesic distances on triangular meshes,
/// WSCG 2002): exact in a plane, a few percent too long or short where it bends. Deterministic.
class SurfaceDistance {
public:
    /// `which`: per triangle, 0: it is left out; empty: none are. The mesh must outlive this.
    explicit SurfaceDistance(const TriangleMesh& mesh, std::span<const char> which = {})
        : mesh_(mesh), corners_({mesh.triangles.data(), static_cast<std::size_t>(mesh.triangles.size())}, static_cast<std::size_t>(mesh.vertices.rows()), which),
          distance_(static_cast<std::size_t>(mesh.vertices.rows()), kFar) {}

    static constexpr double kFar = std::numeric_limits<double>::infinity();

    [[nodiscard]] bool has(std::size_t v) const { return !corners_.at(static_cast<std::int32_t>(v)).empty(); }
    /// Corners of triangles at a vertex, see VertexCorners.
    [[nodiscard]] const VertexCorners& corners() const { return corners_; }

    /// visit(v, distance) for every vertex nearer than `reach` to the sources. Does not go on beyond those where goOn(v, distance) is false.
    template <class GoOn, class Visit>
    void spread(std::span<const SurfaceSource> sources, double reach, const GoOn& goOn, const Visit& visit) {
        using Entry = std::pair<double, std::int32_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
        touched_.clear();
        const auto offer = [&](std::int32_t v, double d) {
            double& known = distance_[static_cast<std::size_t>(v)];
            if (!(d < known) || !(d < reach)) return;
            if (known == kFar) touched_.push_back(v);
            known = d;
            front.emplace(d, v);
        };
        for (const auto& [v, d] : sources) offer(v, d);
        while (!front.empty()) {
            const auto [d, v] = front.top();
            front.pop();
            if (d > distance_[static_cast<std::size_t>(v)] || !goOn(v, d)) continue;
            for (const std::int32_t corner : corners_.at(v)) {
                const std::int32_t f = corner / 3, c = corner % 3;
                const std::int32_t p = mesh_.triangles(f, (c + 1) % 3), q = mesh_.triangles(f, (c + 2) % 3);
                offer(p, d + length(v, p));
                offer(q, d + length(v, q));
                offer(q, across(v, p, q));
                offer(p, across(v, q, p));
            }
        }
        for (const std::int32_t v : touched_) visit(v, std::exchange(distance_[static_cast<std::size_t>(v)], kFar));
    }
    template <class GoOn, class Visit>
    void spread(std::int32_t from, double reach, const GoOn& goOn, const Visit& visit) {
        const SurfaceSource source{from, 0.0};
        spread(std::span(&source, 1), reach, goOn, visit);
    }

private:
    [[nodiscard]] Vec3 at(std::int32_t v) const { return mesh_.vertices.row(v).transpose(); }
    [[nodiscard]] double length(std::int32_t a, std::int32_t b) const { return (at(a) - at(b)).norm(); }
    /// The distance of c straight through triangle a b c, from a source beyond side a b with these distances in its plane; infinite where there is
    /// none.
    [[nodiscard]] double across(std::int32_t a, std::int32_t b, std::int32_t c) const {
        const double da = distance_[static_cast<std::size_t>(a)], db = distance_[static_cast<std::size_t>(b)];
        if (db == kFar) return kFar;
        const Vec3 side = at(b) - at(a), to = at(c) - at(a);
        const double l = side.norm(), x = to.dot(side) / l, y = std::sqrt(std::max(0.0, to.squaredNorm() - x * x));
        const double sx = (da * da - db * db + l * l) / (2.0 * l), square = da * da - sx * sx;
        if (!(square >= 0.0)) return kFar;
        const double sy = std::sqrt(square);  // below the side
        if (!(y + sy > 0.0)) return kFar;
        const double crossing = sx + (x - sx) * sy / (y + sy);
        return crossing >= 0.0 && crossing <= l ? std::hypot(x - sx, y + sy) : kFar;
    }

    const TriangleMesh& mesh_;
    VertexCorners corners_;
    std::vector<double> distance_;
    std::vector<std::int32_t> touched_;
};

}  // namespace imomushi
