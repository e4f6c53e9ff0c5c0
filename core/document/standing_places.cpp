// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/standing_places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/union_find.h"
#include "core/joints/joint_face.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

/// A body stands on what is not higher than this part of its height: on so many patches at most, none smaller than that part of the largest.
constexpr double kStanding = 0.06, kSmallFoot = 0.2;
constexpr std::size_t kMostStanding = 4;
/// A patch is held on a disc of this many least radii at most.
constexpr double kWidestHold = 3.0;

}  // namespace

std::vector<StandingPlace> standingPlaces(const TriangleMesh& body, double least) {
    const Points& vertices = body.vertices;
    const Bounds bounds = boundsOf(vertices);
    const double reach = bounds.low.y() + kStanding * bounds.size().y();
    const auto low = [&](std::int32_t v) { return vertices(v, 1) <= reach; };
    UnionFind connected(static_cast<std::size_t>(vertices.rows()));
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k)
            if (const std::int32_t a = body.triangles(t, k), b = body.triangles(t, (k + 1) % 3); low(a) && low(b)) connected.unite(a, b);
    struct Patch {
        Vec3 sum = Vec3::Zero();
        double area = 0.0;
    };
    std::map<std::int32_t, Patch> patches;  // by the lowest vertex
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const std::int32_t corner = body.triangles(t, 0);
        if (!low(corner) || !low(body.triangles(t, 1)) || !low(body.triangles(t, 2))) continue;
        const Vec3 a = vertices.row(corner), b = vertices.row(body.triangles(t, 1)), c = vertices.row(body.triangles(t, 2));
        const double area = 0.5 * (b - a).cross(c - a).norm();
        Patch& patch = patches[connected.find(corner)];
        patch.sum += area / 3.0 * (a + b + c);
        patch.area += area;
    }
    std::vector<Patch> found;
    for (const auto& [vertex, patch] : patches)
        if (patch.area > 0.0) found.push_back(patch);
    std::stable_sort(found.begin(), found.end(), [](const Patch& a, const Patch& b) { return a.area > b.area; });
    std::vector<StandingPlace> places;
    for (const Patch& patch : found) {
        if (places.size() == kMostStanding || patch.area < kSmallFoot * found.front().area) break;
        Vec3 middle = patch.sum / patch.area;
        middle.y() = bounds.low.y();
        // Half of a patch is its underside, about.
        places.push_back({nearestOnSurface(body, middle).point, std::clamp(std::sqrt(0.5 * patch.area / std::numbers::pi), least, kWidestHold * least)});
    }
    return places;
}

}  // namespace imomushi
