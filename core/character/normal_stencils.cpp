// SPDX-License-Identifier: GPL-3.0-or-later
// Two tangents at rest across the ring of a vertex, from neighbour to neighbour: differences about the middle, which errors of first order leave. A
// part of a third edge makes them exact tangents, and so they stay in every affine motion. Five loads replace a sum over six triangles.
#include "core/character/normal_stencils.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/parallel.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {

namespace {

// Points of a ring that are tried; more triangles than that meet at poles only.
constexpr std::size_t kMaxPoints = 13;
// Edges across the ring that are tried in pairs.
constexpr std::size_t kMaxEdges = 8;
// Larger parts of the third edge magnify noise of positions.
constexpr double kMaxPart = 2.0;
// Heights over the tangent plane that are none, relative to the edges.
constexpr double kFlatCorner = 1e-9;
// Tangents at a sine below this say little about their plane.
constexpr double kMinSine = 0.15;
// What a pair of tangents costs: the middles beside that of the ring, over their lengths; the cosine between them; their tilt.
constexpr double kOffCentre = 1.0, kNarrow = 0.3, kTilted = 3.0;
constexpr std::size_t kGrain = 4096;

class Finder {
public:
    Finder(const Points& vertices, const std::vector<std::int32_t>& triangles, double scale)
        : vertices_(vertices), triangles_(triangles), scale_(scale) {}

    NormalStencil find(std::int32_t v, std::span<const std::int32_t> corners) {
        NormalStencil best{v, v, v, v};
        points_.assign(1, v);
        Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
        double weight = 0.0;
        for (const std::int32_t at_v : corners) {
            const std::int32_t* corner = triangles_.data() + at_v / 3 * 3;
            const Vec3 a = at(corner[0]), b = at(corner[1]), c = at(corner[2]);
            const Vec3 area = (b - a).cross(c - a);
            normal += area;
            centre += area.norm() * (a + b + c) / 3.0;
            weight += area.norm();
            for (int i = 0; i < 3; ++i)
                if (points_.size() < kMaxPoints && std::find(points_.begin(), points_.end(), corner[i]) == points_.end())
                    points_.push_back(corner[i]);
        }
        if (!(weight > 0.0)) return best;
        // Triangles that cancel leave no normal to follow: that of the first one.
        const std::int32_t* first = triangles_.data() + corners.front() / 3 * 3;
        best = {first[1], first[0], first[0], first[2]};
        if (!(normal.norm() > 1e-6 * weight)) return best;
        normal.normalize();
        centre /= weight;

        edges_.clear();
        for (std::size_t i = 0; i < points_.size(); ++i)
            for (std::size_t j = i + 1; j < points_.size(); ++j) {
                const Vec3 a = at(points_[i]), b = at(points_[j]);
                const double length = (a - b).norm();
                if (length > 0.0) edges_.push_back({points_[i], points_[j], ((a + b) / 2.0 - centre).norm() / length});
            }
        const std::size_t some = std::min(kMaxEdges, edges_.size());
        std::partial_sort(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(some), edges_.end(), [](const Edge& a, const Edge& b) { return a.off < b.off; });
        double bestScore = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < some; ++i)
            for (std::size_t j = i + 1; j < some; ++j) tryTangents(v, edges_[i], edges_[j], normal, best, bestScore);
        return best;
    }

private:
    struct Edge {
        std::int32_t from, to;
        double off;  // of its middle from that of the ring, over its length
    };

    [[nodiscard]] Vec3 at(std::int32_t v) const { return scale_ * vertices_.row(v).transpose(); }

    void tryTangents(std::int32_t v, const Edge& one, const Edge& two, const Vec3& normal, NormalStencil& best, double& bestScore) const {
        // The third edge goes to v from the end that is farthest from the tangent plane.
        const Vec3 middle = at(v);
        NormalStencil s{one.to, one.from, two.from, two.to};
        double height = (at(s.c) - middle).dot(normal);
        for (const NormalStencil& other : {NormalStencil{one.to, one.from, two.to, two.from}, NormalStencil{two.to, two.from, one.from, one.to},
                                           NormalStencil{two.to, two.from, one.to, one.from}}) {
            const double h = (at(other.c) - middle).dot(normal);
            if (std::abs(h) <= std::abs(height)) continue;
            height = h;
            s = other;
        }
        Vec3 t = at(s.a) - at(s.b), u = at(s.d) - at(s.c);
        const double ht = t.dot(normal), hu = u.dot(normal), most = std::max(std::abs(ht), std::abs(hu));
        if (most > kFlatCorner * (t.norm() + u.norm()) && most <= kMaxPart * std::abs(height)) {
            s.part[0] = static_cast<float>(ht / height);
            s.part[1] = static_cast<float>(hu / height);
            t += ht / height * (middle - at(s.c));
            u += hu / height * (middle - at(s.c));
        }
        Vec3 across = t.cross(u);
        if (across.dot(normal) < 0.0) {
            std::swap(s.a, s.b);
            s.part[0] = -s.part[0];
            across = -across;
        }
        const double lengths = t.norm() * u.norm();
        if (!(across.norm() > kMinSine * lengths)) return;
        const double score = kOffCentre * (one.off + two.off) + kNarrow * std::abs(t.dot(u)) / lengths + kTilted * (across.normalized() - normal).norm();
        if (!(score < bestScore)) return;
        bestScore = score;
        best = s;
    }

    const Points& vertices_;
    const std::vector<std::int32_t>& triangles_;
    const double scale_;
    std::vector<std::int32_t> points_;
    std::vector<Edge> edges_;
};

}  // namespace

std::vector<NormalStencil> normalStencils(const Points& vertices, const std::vector<std::int32_t>& triangles, double scale) {
    const auto count = static_cast<std::size_t>(vertices.rows());
    std::vector<NormalStencil> out((count + kVertexBlock - 1) / kVertexBlock * kVertexBlock);
    const VertexCorners corners(triangles, count);
    parallelFor(hardwareThreads(), count, kGrain, [&](std::size_t begin, std::size_t end) {
        Finder finder(vertices, triangles, scale);
        for (std::size_t v = begin; v < end; ++v)
            out[v] = finder.find(static_cast<std::int32_t>(v), corners.at(static_cast<std::int32_t>(v)));
    });
    return out;
}

}  // namespace imomushi
