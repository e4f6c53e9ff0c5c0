// SPDX-License-Identifier: GPL-3.0-or-later
// Three points of the ring of a vertex span a plane that turns with the surface; what its normal differs at rest from the area-weighted one is kept
// as components along the plane. Three loads per vertex replace a sum over six triangles.
#include "core/character/normal_stencils.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"

namespace imomushi {

namespace {

// Points of a ring that are tried; more triangles than that meet at poles only.
constexpr std::size_t kMostCandidates = 9;
// Planes steeper than this (cosine) against the wanted normal say little about it.
constexpr double kLeastCosine = 0.25;
// What a plane beside the middle of the ring costs, against a tilted one: both are lengths over the size of the ring.
constexpr double kOffCentre = 0.3;
// Narrow triangles magnify noise of positions.
constexpr double kNarrow = 0.02;
constexpr std::size_t kGrain = 4096;

/// Triangles around every vertex.
struct Rings {
    std::vector<std::int32_t> first, triangle;
    Rings(std::size_t vertices, const std::vector<std::int32_t>& triangles) : first(vertices + 1, 0), triangle(triangles.size()) {
        for (const auto v : triangles) ++first[v + 1];
        for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
        auto next = first;
        for (std::size_t i = 0; i < triangles.size(); ++i) triangle[next[triangles[i]]++] = static_cast<std::int32_t>(i / 3);
    }
};

class Finder {
public:
    Finder(const Points& vertices, const std::vector<std::int32_t>& triangles, double scale)
        : vertices_(vertices), triangles_(triangles), scale_(scale) {}

    NormalStencil find(std::int32_t v, const std::int32_t* begin, const std::int32_t* end) {
        points_.assign(1, v);
        Vec3 wanted = Vec3::Zero(), centre = Vec3::Zero();
        double weight = 0.0;
        for (const auto* t = begin; t != end; ++t) {
            const std::int32_t* corner = triangles_.data() + 3 * static_cast<std::ptrdiff_t>(*t);
            const Vec3 a = at(corner[0]), b = at(corner[1]), c = at(corner[2]);
            const Vec3 area = (b - a).cross(c - a);
            wanted += area;
            centre += area.norm() * (a + b + c) / 3.0;
            weight += area.norm();
            for (int i = 0; i < 3; ++i)
                if (points_.size() < kMostCandidates && std::find(points_.begin(), points_.end(), corner[i]) == points_.end())
                    points_.push_back(corner[i]);
        }
        NormalStencil best{v, v, v};
        const double length = wanted.norm();
        if (!(weight > 0.0)) return best;
        // Triangles that cancel leave no normal to follow: that of the first one.
        if (!(length > 1e-6 * weight)) {
            const std::int32_t* corner = triangles_.data() + 3 * static_cast<std::ptrdiff_t>(*begin);
            return {corner[1], corner[2], corner[0]};
        }
        const Vec3 normal = wanted / length;
        centre /= weight;
        double bestScore = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < points_.size(); ++i)
            for (std::size_t j = i + 1; j < points_.size(); ++j)
                for (std::size_t k = j + 1; k < points_.size(); ++k) tryPlane(points_[i], points_[j], points_[k], normal, centre, best, bestScore);
        return best;
    }

private:
    [[nodiscard]] Vec3 at(std::int32_t v) const { return scale_ * vertices_.row(v).transpose(); }

    void tryPlane(std::int32_t a, std::int32_t b, std::int32_t c, const Vec3& normal, const Vec3& centre, NormalStencil& best, double& bestScore) const {
        const Vec3 p = at(c);
        Vec3 t = at(a) - p, s = at(b) - p;
        Vec3 across = t.cross(s);
        if (across.dot(normal) < 0.0) {
            std::swap(a, b);
            std::swap(t, s);
            across = -across;
        }
        const double area = across.norm(), edges = t.squaredNorm() + s.squaredNorm() + (t - s).squaredNorm();
        if (!(area > 1e-6 * edges)) return;
        const double cosine = across.dot(normal) / area;
        if (cosine < kLeastCosine) return;
        // normal * area / cosine = across + r, with r in the plane: its components are the wanted ones.
        const Vec3 r = normal * (area / cosine) - across;
        const double tilt = r.norm() / area;
        const double off = ((t + s) / 3.0 + p - centre).norm() / std::sqrt(edges);
        const double score = tilt + kOffCentre * off + kNarrow * edges / area;
        if (!(score < bestScore)) return;
        bestScore = score;
        const double square = area * area;
        best = {a, b, c, {static_cast<float>(r.cross(s).dot(across) / square), static_cast<float>(t.cross(r).dot(across) / square)}};
    }

    const Points& vertices_;
    const std::vector<std::int32_t>& triangles_;
    const double scale_;
    std::vector<std::int32_t> points_;
};

}  // namespace

std::vector<NormalStencil> normalStencils(const Points& vertices, const std::vector<std::int32_t>& triangles, double scale) {
    const auto count = static_cast<std::size_t>(vertices.rows());
    std::vector<NormalStencil> out((count + kVertexBlock - 1) / kVertexBlock * kVertexBlock);
    const Rings rings(count, triangles);
    parallelFor(hardwareThreads(), count, kGrain, [&](std::size_t begin, std::size_t end) {
        Finder finder(vertices, triangles, scale);
        for (std::size_t v = begin; v < end; ++v)
            out[v] = finder.find(static_cast<std::int32_t>(v), rings.triangle.data() + rings.first[v], rings.triangle.data() + rings.first[v + 1]);
    });
    return out;
}

}  // namespace imomushi
