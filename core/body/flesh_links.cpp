// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/flesh_links.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <queue>
#include <set>
#include <tuple>

#include "core/base/index.h"
#include "core/base/union_find.h"
#include "core/body/cgal/rays.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {
namespace {

// Distances over the size of all parts together.
constexpr double kLinked = 0.065;       ///< parts that are farther apart are linked only where their bones are neighbours,
constexpr double kLinkedByBones = 0.2;  ///< and never beyond this
constexpr double kOtherBones = 4.0;     ///< parts of bones that are not neighbours count as this many times as far apart
constexpr double kCarriedPart = 0.04;      ///< volume over that of the largest part: one without a motion of its own that is smaller is attached
constexpr double kMostCarried = 0.04;   ///< volume of what is attached over that of all: what is lost stays well below what a body may lose
constexpr int kBoneSteps = 3;              ///< from bone to bone in a skeleton: a ball between two limbs may have a bone or none

/// How near two parts come to each other.
struct Nearness {
    double distance = 0.0;
    Vec3 onFirst, onSecond;
};

Vec3 placeOf(const TriangleMesh& mesh, const TriangleTree::Hit& hit) {
    Vec3 place = Vec3::Zero();
    for (int k = 0; k < 3; ++k) place += hit.barycentric[k] * mesh.vertices.row(mesh.triangles(hit.triangle, k)).transpose();
    return place;
}

/// From the vertices of each to the surface of the other: edges that pass each other are nearer still, which is near enough here.
Nearness nearness(const TriangleMesh& a, const TriangleTree& treeA, const TriangleMesh& b, const TriangleTree& treeB) {
    Nearness found{std::numeric_limits<double>::infinity(), {}, {}};
    for (const bool second : {false, true}) {
        const TriangleMesh &from = second ? b : a, &to = second ? a : b;
        const TriangleTree& tree = second ? treeA : treeB;
        for (Eigen::Index v = 0; v < from.vertices.rows(); ++v) {
            const Vec3 p = from.vertices.row(v);
            const auto hit = tree.nearest(p);
            if (const double d = std::sqrt(hit.squaredDistance); d < found.distance) {
                found.distance = d;
                (second ? found.onSecond : found.onFirst) = p;
                (second ? found.onFirst : found.onSecond) = placeOf(to, hit);
            }
        }
    }
    return found;
}

/// The bones that move a good part of a part, the most first.
std::vector<std::int32_t> bonesOf(const FleshPart& part) {
    std::map<std::int32_t, std::size_t> count;
    for (const std::int32_t b : part.bone)
        if (b >= 0) ++count[b];
    std::vector<std::int32_t> bones;
    for (const auto& [b, n] : count)
        if (5 * n >= part.bone.size()) bones.push_back(b);
    std::stable_sort(bones.begin(), bones.end(), [&](std::int32_t x, std::int32_t y) { return count[x] > count[y]; });
    return bones;
}

/// Whether bones are the same or a few steps from each other.
bool related(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b, const std::vector<std::int32_t>& parents) {
    const auto above = [&](std::int32_t bone) {
        std::vector<std::int32_t> chain{bone};
        while (chain.size() <= kBoneSteps && at(bone) < parents.size() && parents[at(bone)] >= 0) chain.push_back(bone = parents[at(bone)]);
        return chain;
    };
    for (const std::int32_t x : a)
        for (const std::int32_t y : b) {
            const auto up = above(x), other = above(y);
            for (std::size_t i = 0; i < up.size(); ++i)
                for (std::size_t j = 0; i + j <= kBoneSteps && j < other.size(); ++j)
                    if (up[i] == other[j]) return true;
        }
    return false;
}

}  // namespace

Linking planLinks(const std::vector<FleshPart>& parts, const std::vector<std::pair<std::int32_t, std::int32_t>>& touching, const std::vector<std::int32_t>& parents, double size, bool carry, const Progress& progress) {
    const std::size_t count = parts.size();
    Linking out;
    out.attached.assign(count, 0);
    std::vector<Bounds> box;
    std::vector<std::vector<std::int32_t>> bones;
    for (const FleshPart& part : parts) {
        box.push_back(boundsOf(part.mesh.vertices));
        bones.push_back(bonesOf(part));
    }
    std::vector<std::unique_ptr<TriangleTree>> trees(count);
    const auto treeOf = [&](std::size_t i) -> const TriangleTree& {
        if (!trees[i]) trees[i] = std::make_unique<TriangleTree>(parts[i].mesh);
        return *trees[i];
    };
    // The shortest tree over all parts. Most pairs are never measured: boxes say how near two can be at best.
    struct Candidate {
        double cost;
        std::int32_t a, b;
        bool measured;
        bool operator>(const Candidate& other) const { return std::tie(cost, a, b, measured) > std::tie(other.cost, other.a, other.b, other.measured); }
    };
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> open;
    /// What a distance between two parts counts as; none: they are too far apart to be linked.
    const auto cost = [&](std::size_t a, std::size_t b, double distance) -> std::optional<double> {
        if (distance > kLinkedByBones * size) return std::nullopt;
        const bool known = !bones[a].empty() && !bones[b].empty(), near = known && related(bones[a], bones[b], parents);
        if (distance > (near ? kLinkedByBones : kLinked) * size) return std::nullopt;
        return known && !near ? kOtherBones * distance : distance;
    };
    for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a + 1; b < count; ++b) {
            const Vec3 gap = (box[a].low - box[b].high).cwiseMax(box[b].low - box[a].high).cwiseMax(0.0);
            if (const auto least = cost(a, b, gap.norm())) open.push({*least, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), false});
        }
    UnionFind joined(count);
    std::vector<std::vector<std::int32_t>> neighbours(count);
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (joined.find(a) == joined.find(b)) return false;
        joined.unite(a, b);
        neighbours[at(a)].push_back(b);
        neighbours[at(b)].push_back(a);
        return true;
    };
    for (const auto& [a, b] : touching) join(a, b);
    while (!open.empty() && !progress.cancelled()) {
        Candidate next = open.top();
        open.pop();
        if (joined.find(next.a) == joined.find(next.b)) continue;
        const std::size_t a = at(next.a), b = at(next.b);
        if (!next.measured) {
            const auto measured = cost(a, b, nearness(parts[a].mesh, treeOf(a), parts[b].mesh, treeOf(b)).distance);
            if (!measured) continue;
            next.cost = *measured;
            next.measured = true;
            open.push(next);
            continue;
        }
        if (join(next.a, next.b)) out.pairs.emplace_back(next.a, next.b);
    }

    std::map<std::int32_t, double> flesh;  // bone: the largest volume of a part whose first bone it is
    double largest = 0.0;
    for (std::size_t p = 0; p < count; ++p) {
        largest = std::max(largest, parts[p].volume);
        if (!bones[p].empty()) flesh[bones[p].front()] = std::max(flesh[bones[p].front()], parts[p].volume);
    }
    const auto carried = [&](std::size_t p) {
        if (parts[p].small) return true;
        if (parts[p].volume >= kCarriedPart * largest || bones[p].empty()) return false;
        return flesh[bones[p].front()] > parts[p].volume;
    };
    // From the ends of the trees inward, the smallest first, as long as little is lost.
    std::vector<std::size_t> degree(count);
    std::set<std::pair<double, std::size_t>> ends;
    double all = 0.0, lost = 0.0;
    for (std::size_t p = 0; p < count; ++p) {
        all += parts[p].volume;
        degree[p] = neighbours[p].size();
        if (degree[p] <= 1) ends.emplace(parts[p].volume, p);
    }
    while (carry && !ends.empty()) {
        const std::size_t p = ends.begin()->second;
        ends.erase(ends.begin());
        if (degree[p] == 0 || !carried(p) || lost + parts[p].volume > kMostCarried * all) continue;
        out.attached[p] = 1;
        lost += parts[p].volume;
        for (const std::int32_t n : neighbours[p])
            if (out.attached[at(n)] == 0 && --degree[at(n)] == 1) ends.emplace(parts[at(n)].volume, at(n));
    }
    std::erase_if(out.pairs, [&](const auto& pair) { return out.attached[at(pair.first)] != 0 || out.attached[at(pair.second)] != 0; });
    return out;
}

namespace {

constexpr int kFacingRays = 25;         ///< rays each way over the places where two parts may face each other
constexpr int kTubeSides = 16;        ///< of a tube
constexpr double kTubeTurned = 0.13;  ///< radians: no side of a tube is parallel to a side of a box
constexpr int kTubeRings = 8;

/// Where a line from between two parts meets them: in and out again.
struct Crossing {
    bool both = false;
    std::array<double, 2> in{}, out{};  ///< of each part, distances from the start; part 0 lies backward
};

class Facing {
public:
    /// Where the two are nearest to each other, or at `where`.
    Facing(const TriangleMesh& a, const TriangleMesh& b, std::optional<Nearness> where = std::nullopt) : mesh_{&a, &b}, rays_{std::make_unique<RayTree>(a), std::make_unique<RayTree>(b)} {
        const TriangleTree treeA(a), treeB(b);
        const Nearness near = where ? *where : nearness(a, treeA, b, treeB);
        distance_ = near.distance;
        const Bounds boxA = boundsOf(a.vertices), boxB = boundsOf(b.vertices);
        size_ = 0.5 * std::min(boxA.diagonal(), boxB.diagonal());
        normal_ = near.onSecond - near.onFirst;
        // Where the gap is next to nothing, the surfaces say across what it is.
        if (near.distance < 1e-4 * size_) {
            const auto hitA = treeA.nearest(near.onFirst), hitB = treeB.nearest(near.onSecond);
            normal_ = areaVector(a, hitA.triangle).normalized() - areaVector(b, hitB.triangle).normalized();
        }
        if (!(normal_.norm() > 0.0)) normal_ = Vec3::UnitY();
        normal_.normalize();
        axes_.col(0) = normal_.unitOrthogonal();
        axes_.col(1) = normal_.cross(axes_.col(0));
        middle_ = 0.5 * (near.onFirst + near.onSecond);
    }

    [[nodiscard]] Crossing at(const Eigen::Vector2d& p) const {
        Crossing c;
        const Vec3 from = middle_ + axes_ * p;
        for (std::size_t side = 0; side < 2; ++side) {
            const Vec3 way = side == 0 ? Vec3(-normal_) : normal_;
            const auto in = rays_[side]->first(from, way, distance_ + size_, -1);
            if (in.triangle < 0 || areaVector(*mesh_[side], in.triangle).dot(way) >= 0.0) return c;  // it begins within the part
            // Nothing of the other part lies between.
            if (rays_[1 - side]->first(from, way, in.distance, -1).triangle >= 0) return c;
            // A ray that comes in by an edge or a vertex meets all triangles there.
            const double within = in.distance + 1e-6 * size_;
            const auto out = rays_[side]->first(from + within * way, way, 8.0 * size_ + distance_, -1);
            if (out.triangle < 0) return c;
            c.in[side] = in.distance;
            c.out[side] = within + out.distance;
        }
        c.both = true;
        return c;
    }

    /// The largest disc in which the two face each other: its middle in the plane between them, and its radius; 0: none.
    [[nodiscard]] std::pair<Eigen::Vector2d, double> disc() const {
        Eigen::Vector2d center = Eigen::Vector2d::Zero();
        double half = size_, radius = 0.0;
        for (int round = 0; round < 6; ++round) {
            const double step = 2.0 * half / (kFacingRays - 1);
            std::vector<Eigen::Vector2d> facing, apart;
            for (int i = -1; i <= kFacingRays; ++i)
                for (int j = -1; j <= kFacingRays; ++j) {
                    const Eigen::Vector2d p = center + Eigen::Vector2d(i * step - half, j * step - half);
                    const bool border = i < 0 || j < 0 || i == kFacingRays || j == kFacingRays;
                    (!border && at(p).both ? facing : apart).push_back(p);
                }
            if (facing.empty()) {  // a place smaller than the grid
                half /= 4.0;
                continue;
            }
            double best = 0.0;
            Eigen::Vector2d where = center;
            for (const Eigen::Vector2d& p : facing) {
                double least = std::numeric_limits<double>::infinity();
                for (const Eigen::Vector2d& q : apart) least = std::min(least, (p - q).squaredNorm());
                if (least > best) best = least, where = p;
            }
            center = where;
            radius = std::max(0.0, std::sqrt(best) - step);
            if (radius >= 6.0 * step) break;
            half = std::max(2.0 * radius, 2.0 * step);  // looked at more closely
        }
        return {center, radius};
    }

    [[nodiscard]] Vec3 lifted(const Eigen::Vector2d& p, double along) const { return middle_ + axes_ * p + along * normal_; }

private:
    std::array<const TriangleMesh*, 2> mesh_;
    std::array<std::unique_ptr<RayTree>, 2> rays_;
    double distance_ = 0.0, size_ = 0.0;
    Vec3 normal_, middle_;
    Eigen::Matrix<double, 3, 2> axes_;
};

/// A tube around `center` in the plane between two parts; none where they do not face each other all around.
std::optional<LinkTube> tubeAt(const Facing& facing, const Eigen::Vector2d& center, double radius) {
    std::vector<Eigen::Vector2d> ring;
    for (int i = 0; i < kTubeSides; ++i) {
        const double angle = kTubeTurned + 2.0 * std::numbers::pi * i / kTubeSides;
        ring.push_back(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    // Each end lies within its part all around.
    std::array<double, 2> end{};
    double gap = 0.0;
    const Crossing axis = facing.at(center);
    for (std::size_t side = 0; side < 2; ++side) {
        double in = axis.in[side], out = axis.out[side];
        for (const Eigen::Vector2d& p : ring) {
            const Crossing c = facing.at(p);
            if (!c.both) return std::nullopt;
            in = std::max(in, c.in[side]);
            out = std::min(out, c.out[side]);
        }
        if (!(out > in)) return std::nullopt;
        end[side] = in + std::min(0.5 * (out - in), radius);
        gap += axis.in[side];
    }
    const double length = end[0] + end[1];
    const int rings = static_cast<int>(std::lround(std::clamp(length * kTubeSides / (4.0 * std::numbers::pi * radius), 1.0, double{kTubeRings})));
    LinkTube tube;
    tube.mesh.vertices.resize((rings + 1) * kTubeSides + 2, 3);
    for (int r = 0; r <= rings; ++r)
        for (int i = 0; i < kTubeSides; ++i) tube.mesh.vertices.row(r * kTubeSides + i) = facing.lifted(ring[at(i)], -end[0] + length * r / rings).transpose();
    const int first = (rings + 1) * kTubeSides, last = first + 1;
    tube.mesh.vertices.row(first) = facing.lifted(center, -end[0]).transpose();
    tube.mesh.vertices.row(last) = facing.lifted(center, end[1]).transpose();
    tube.mesh.triangles.resize(2 * kTubeSides * (rings + 1), 3);
    Eigen::Index f = 0;
    for (int i = 0; i < kTubeSides; ++i) {
        const int j = (i + 1) % kTubeSides;
        tube.mesh.triangles.row(f++) << first, j, i;
        for (int r = 0; r < rings; ++r) {
            const int lower = r * kTubeSides, upper = lower + kTubeSides;
            tube.mesh.triangles.row(f++) << lower + i, lower + j, upper + j;
            tube.mesh.triangles.row(f++) << lower + i, upper + j, upper + i;
        }
        tube.mesh.triangles.row(f++) << last, rings * kTubeSides + i, rings * kTubeSides + j;
    }
    tube.link.from = facing.lifted(center, -axis.in[0]);
    tube.link.to = facing.lifted(center, axis.in[1]);
    tube.link.radius = radius;
    return tube;
}

}  // namespace

std::optional<LinkTube> linkTube(const TriangleMesh& a, const TriangleMesh& b, double part) {
    const Facing facing(a, b);
    const auto [center, disc] = facing.disc();
    return disc > 0.0 ? tubeAt(facing, center, part * disc) : std::nullopt;
}

std::optional<LinkTube> linkTube(const TriangleMesh& a, const TriangleMesh& b, const FleshLink& asked) {
    return tubeAt(Facing(a, b, Nearness{(asked.to - asked.from).norm(), asked.from, asked.to}), Eigen::Vector2d::Zero(), asked.radius);
}

}  // namespace imomushi
