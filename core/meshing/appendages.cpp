// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/appendages.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "core/base/index.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/topology.h"
#include "core/mesh/vertex_corners.h"

namespace imomushi {
namespace {

/// Distances closer than this, relative to the largest, are one level: they differ by rounding.
constexpr double kSameLevel = 1e-9;
/// An appendage is cut between these many widths above its foot, where its loop is shortest: strain has nearly gone, and S is not small yet.
constexpr double kLowestCut = 0.5, kHighestCut = 1.0;
/// Levels tried for the cut; of equally short loops the highest is taken.
constexpr int kTries = 12;
/// A cap is a fan around its middle: each of its triangles must face the cap's way (cosine).
constexpr double kFanFacing = 0.25;


/// Per vertex, m: along edges from the nearest joint face (Dijkstra).
std::vector<double> distancesFrom(const TriangleMesh& body, std::span<const JointFace> faces, const VertexCorners& around) {
    std::vector<double> distance(static_cast<std::size_t>(body.vertices.rows()), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const JointFace& face : faces)
        for (const std::int32_t v : face.vertices) {
            distance[at(v)] = 0.0;
            queue.emplace(0.0, v);
        }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > distance[at(v)]) continue;
        for (const std::int32_t corner : around.at(v))
            for (int c = 0; c < 3; ++c) {
                const std::int32_t to = body.triangles(corner / 3, c);
                const double reached = d + (body.vertices.row(to) - body.vertices.row(v)).norm();
                if (reached < distance[at(to)]) {
                    distance[at(to)] = reached;
                    queue.emplace(reached, to);
                }
            }
    }
    return distance;
}

/// Where an appendage leaves the body.
struct Foot {
    std::int32_t tip = 0;   ///< its farthest vertex
    double distance = 0.0;  ///< m, from the faces
    double width = 0.0;     ///< m
    double excess = 0.0;    ///< m, its length less kSlender widths
};

/// Follows the parts of the surface that are farther from the faces than a level, while the level falls (a merge tree). The nearer side of a level
/// always reaches a face, since every vertex has a neighbour that is nearer.
class Sweep {
public:
    Sweep(const TriangleMesh& body, const EdgeTable& edges, const VertexCorners& around, const std::vector<double>& distance)
        : body_(body), edges_(edges), around_(around), distance_(distance), parent_(distance.size(), -1), parts_(distance.size()), owner_(static_cast<std::size_t>(body.triangles.rows()), -1) {}

    /// The feet, none within another.
    std::vector<Foot> feet();

private:
    struct Part {
        int euler = 0;           ///< vertices - edges + triangles that have all corners in it: 1 where it is a disc
        double perimeter = 0.0;  ///< m, of the loop around all triangles that touch it
        double moment = 0.0;     ///< m^2, perimeter times the mean distance of the loop from the faces
        std::int32_t tip = 0;
        std::vector<Foot> feet;
    };
    /// Unlike in UnionFind the vertex that was reached last represents its part.
    std::int32_t find(std::int32_t v) {
        while (parent_[at(v)] != v) v = parent_[at(v)] = parent_[at(parent_[at(v)])];
        return v;
    }
    Part& partOf(std::int32_t v) { return parts_[at(find(v))]; }
    void add(std::int32_t v);

    const TriangleMesh& body_;
    const EdgeTable& edges_;
    const VertexCorners& around_;
    const std::vector<double>& distance_;
    std::vector<std::int32_t> parent_;  ///< -1: not reached yet
    std::vector<Part> parts_;
    std::vector<std::int32_t> owner_;  ///< per triangle: its first vertex that was reached
};

void Sweep::add(std::int32_t v) {
    parent_[at(v)] = v;
    Part own{1, 0.0, 0.0, v, {}};
    int sides = 0;  // each edge at v is seen from both of its triangles
    for (const std::int32_t corner : around_.at(v)) {
        const std::int32_t t = corner / 3;
        int reached = 0;
        for (int c = 0; c < 3; ++c) {
            const std::int32_t other = body_.triangles(t, c);
            if (other == v || parent_[at(other)] < 0) continue;
            ++reached;
            const std::int32_t root = find(other);
            if (root == v) continue;
            Part& part = parts_[at(root)];
            own.euler += part.euler;
            own.perimeter += part.perimeter;
            own.moment += part.moment;
            if (distance_[at(part.tip)] > distance_[at(own.tip)]) own.tip = part.tip;
            own.feet.insert(own.feet.end(), part.feet.begin(), part.feet.end());
            part.feet = {};
            parent_[at(root)] = v;
        }
        sides += reached;
        if (reached == 2) ++own.euler;
    }
    own.euler -= sides / 2;
    parts_[at(v)] = std::move(own);
    for (const std::int32_t corner : around_.at(v)) {
        const std::int32_t t = corner / 3;
        if (owner_[at(t)] >= 0) continue;
        owner_[at(t)] = v;
        for (int c = 0; c < 3; ++c) {
            const std::int32_t from = body_.triangles(t, c), to = body_.triangles(t, (c + 1) % 3);
            std::int32_t beyond = -1;
            for (const EdgeUse& use : edges_.uses(edges_.edgeOf(t, c)))
                if (use.triangle != t) beyond = owner_[at(use.triangle)];
            // A side of the loop, or one that no longer is.
            const double length = (beyond < 0 ? 1.0 : -1.0) * (body_.vertices.row(to) - body_.vertices.row(from)).norm();
            Part& part = partOf(beyond < 0 ? v : beyond);
            part.perimeter += length;
            part.moment += 0.5 * length * (distance_[at(from)] + distance_[at(to)]);
        }
    }
}

std::vector<Foot> Sweep::feet() {
    std::vector<std::int32_t> order;
    for (std::size_t v = 0; v < distance_.size(); ++v)
        if (distance_[v] > 0.0 && std::isfinite(distance_[v])) order.push_back(static_cast<std::int32_t>(v));
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return distance_[at(a)] > distance_[at(b)]; });
    const double same = order.empty() ? 0.0 : kSameLevel * distance_[at(order.front())];
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        for (; end < order.size() && (end == begin || distance_[at(order[end - 1])] - distance_[at(order[end])] <= same); ++end) add(order[end]);
        for (std::size_t i = begin; i < end; ++i) {
            Part& part = partOf(order[i]);
            const double distance = distance_[at(order[i])], width = part.perimeter / std::numbers::pi;
            const Foot foot{part.tip, distance, width, distance_[at(part.tip)] - part.moment / part.perimeter - kSlender * width};
            if (part.euler != 1 || !(part.perimeter > 0.0) || !(foot.excess > 0.0) || distance < width) continue;
            if (std::any_of(part.feet.begin(), part.feet.end(), [&](const Foot& higher) { return higher.excess > foot.excess; })) continue;
            part.feet = {foot};
        }
    }
    std::vector<Foot> out;
    for (const std::int32_t v : order)
        if (parent_[at(v)] == v) out.insert(out.end(), parts_[at(v)].feet.begin(), parts_[at(v)].feet.end());
    return out;
}

/// A disc of the surface that can be cut off.
struct Disc {
    std::vector<std::int32_t> loop;       ///< kept vertices around it, as its triangles wind there
    std::vector<std::int32_t> triangles;  ///< ascending
    std::vector<std::int32_t> vertices;   ///< its own, ascending
    double width = 0.0, length = 0.0;  ///< m: perimeter of the loop / pi; along edges from the loop to the tip
    Vec3 middle = Vec3::Zero();        ///< of the loop
};

/// What lies around `tip` at least `level` away from the faces. Empty: no simple loop bounds it, it is not longer than wide, or no cap fits there.
std::optional<Disc> discBeyond(const TriangleMesh& body, const EdgeTable& edges, const VertexCorners& around, const std::vector<double>& distance, std::int32_t tip, double level) {
    Disc out;
    std::vector<char> inside(distance.size()), taken(static_cast<std::size_t>(body.triangles.rows()));
    std::vector<std::int32_t> reached{tip};
    inside[at(tip)] = 1;
    for (std::size_t i = 0; i < reached.size(); ++i)
        for (const std::int32_t corner : around.at(reached[i])) {
            const std::int32_t t = corner / 3;
            if (!taken[at(t)]) out.triangles.push_back(t);
            taken[at(t)] = 1;
            for (int c = 0; c < 3; ++c) {
                const std::int32_t v = body.triangles(t, c);
                if (inside[at(v)] || distance[at(v)] < level) continue;
                inside[at(v)] = 1;
                reached.push_back(v);
            }
        }
    std::sort(out.triangles.begin(), out.triangles.end());

    std::vector<std::pair<std::int32_t, std::int32_t>> sides;  // from, to
    for (const std::int32_t t : out.triangles)
        for (int c = 0; c < 3; ++c) {
            const auto uses = edges.uses(edges.edgeOf(t, c));
            if (std::all_of(uses.begin(), uses.end(), [&](const EdgeUse& use) { return taken[at(use.triangle)] != 0; })) continue;
            sides.emplace_back(body.triangles(t, c), body.triangles(t, (c + 1) % 3));
        }
    std::sort(sides.begin(), sides.end());
    if (sides.empty()) return std::nullopt;
    std::int32_t v = sides.front().first;
    do {
        const auto side = std::lower_bound(sides.begin(), sides.end(), std::pair(v, std::int32_t{-1}));
        if (side == sides.end() || side->first != v || out.loop.size() == sides.size() || distance[at(v)] == 0.0) return std::nullopt;
        out.loop.push_back(v);
        v = side->second;
    } while (v != sides.front().first);
    if (out.loop.size() != sides.size()) return std::nullopt;

    for (const std::int32_t t : out.triangles)
        for (int c = 0; c < 3; ++c) out.vertices.push_back(body.triangles(t, c));
    std::sort(out.vertices.begin(), out.vertices.end());
    out.vertices.erase(std::unique(out.vertices.begin(), out.vertices.end()), out.vertices.end());
    const std::size_t edgesOfDisc = (3 * out.triangles.size() + sides.size()) / 2;
    if (out.vertices.size() + out.triangles.size() != edgesOfDisc + 1) return std::nullopt;
    for (const std::int32_t l : out.loop) out.vertices.erase(std::lower_bound(out.vertices.begin(), out.vertices.end(), l));

    const auto point = [&](std::size_t i) -> Vec3 { return body.vertices.row(out.loop[i % out.loop.size()]).transpose(); };
    const Vec3 first = point(0);
    double perimeter = 0.0;
    for (std::size_t i = 0; i < out.loop.size(); ++i) {
        const double side = (point(i + 1) - point(i)).norm();
        perimeter += side;
        out.middle += 0.5 * side * (point(i) + point(i + 1) - 2.0 * first);
        out.length += (distance[at(tip)] - distance[at(out.loop[i])]) / static_cast<double>(out.loop.size());
    }
    out.width = perimeter / std::numbers::pi;
    if (!(out.length >= out.width)) return std::nullopt;
    out.middle = first + out.middle / perimeter;
    Vec3 whole = Vec3::Zero();
    for (std::size_t i = 0; i < out.loop.size(); ++i) whole += (point(i) - out.middle).cross(point(i + 1) - out.middle);
    for (std::size_t i = 0; i < out.loop.size(); ++i) {
        const Vec3 part = (point(i) - out.middle).cross(point(i + 1) - out.middle);
        if (!(part.dot(whole) > kFanFacing * part.norm() * whole.norm())) return std::nullopt;
    }
    return out;
}

/// The disc with the shortest loop somewhat above a foot.
std::optional<Disc> bestDisc(const TriangleMesh& body, const EdgeTable& edges, const VertexCorners& around, const std::vector<double>& distance, const Foot& foot) {
    std::optional<Disc> best;
    for (int i = 0; i <= kTries; ++i) {
        const double above = foot.width * (kLowestCut + (kHighestCut - kLowestCut) * i / kTries);
        auto disc = discBeyond(body, edges, around, distance, foot.tip, foot.distance + above);
        if (disc && (!best || disc->width < (1.0 + kSameLevel) * best->width)) best = std::move(disc);
    }
    return best;
}

}  // namespace

Result<TrimmedBody> withoutAppendages(const ElementMesh& element, std::span<const JointFace> faces, const Progress& progress) {
    const TriangleMesh& body = element.body;
    TrimmedBody whole{body, {faces.begin(), faces.end()}, std::vector<std::int32_t>(static_cast<std::size_t>(body.vertices.rows())), {}};
    std::iota(whole.bodyVertex.begin(), whole.bodyVertex.end(), 0);
    if (faces.empty()) return whole;
    const EdgeTable& edges = element.connectivity().edges();
    if (2 * static_cast<Eigen::Index>(edges.size()) != body.triangles.size()) return whole;  // not closed, which the solver refuses
    for (int e = 0; e < edges.size(); ++e)
        if (edges.uses(e).size() != 2) return whole;
    int shells = 0;
    edgeComponents(body.triangles, edges, shells);
    if (shells != 1) return whole;
    const VertexCorners& around = element.connectivity().corners();
    const std::vector<double> distance = distancesFrom(body, faces, around);

    TrimmedBody out;
    std::vector<Disc> discs;
    std::vector<char> dropped(distance.size()), gone(static_cast<std::size_t>(body.triangles.rows()));
    for (const Foot& foot : Sweep(body, edges, around, distance).feet()) {
        if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");
        auto disc = bestDisc(body, edges, around, distance, foot);
        if (!disc) continue;
        for (const std::int32_t v : disc->vertices) dropped[at(v)] = 1;
        for (const std::int32_t t : disc->triangles) gone[at(t)] = 1;
        out.appendages.push_back({disc->width, disc->length, {}, disc->vertices});
        discs.push_back(std::move(*disc));
    }
    if (discs.empty()) return whole;

    std::vector<std::int32_t> vertex(dropped.size(), -1), triangle(gone.size(), -1), corners;
    for (std::size_t v = 0; v < vertex.size(); ++v)
        if (!dropped[v]) {
            vertex[v] = static_cast<std::int32_t>(out.bodyVertex.size());
            out.bodyVertex.push_back(static_cast<std::int32_t>(v));
        }
    for (std::int32_t t = 0; t < body.triangles.rows(); ++t)
        if (!gone[at(t)]) {
            triangle[at(t)] = static_cast<std::int32_t>(corners.size() / 3);
            for (int c = 0; c < 3; ++c) corners.push_back(vertex[at(body.triangles(t, c))]);
        }
    const auto kept = static_cast<Eigen::Index>(out.bodyVertex.size());
    out.mesh.vertices.resize(kept + static_cast<Eigen::Index>(discs.size()), 3);
    for (Eigen::Index v = 0; v < kept; ++v) out.mesh.vertices.row(v) = body.vertices.row(out.bodyVertex[static_cast<std::size_t>(v)]);
    for (std::size_t d = 0; d < discs.size(); ++d) {
        const auto middle = static_cast<std::int32_t>(out.bodyVertex.size());
        out.mesh.vertices.row(middle) = discs[d].middle.transpose();
        out.bodyVertex.push_back(-1);
        std::vector<std::int32_t>& support = out.appendages[d].support;
        for (const std::int32_t v : discs[d].loop) support.push_back(vertex[at(v)]);
        for (std::size_t i = 0; i < discs[d].loop.size(); ++i) corners.insert(corners.end(), {support[i], support[(i + 1) % discs[d].loop.size()], middle});
        support.push_back(middle);
    }
    out.mesh.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    if (!selfIntersections(out.mesh, 1, progress).empty()) return whole;
    out.faces = whole.faces;
    for (JointFace& face : out.faces) {
        for (std::int32_t& v : face.vertices) v = vertex[at(v)];
        for (std::int32_t& t : face.triangles) t = triangle[at(t)];
    }
    return out;
}

}  // namespace imomushi
