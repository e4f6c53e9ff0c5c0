// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>
#include <utility>

#include "core/base/finite.h"
#include "core/mesh/triangle_order.h"

namespace imomushi {
namespace {

/// Vertices this near to the plane, in diagonals of the body, lie on it: rounding of coordinates about as large as the body.
constexpr double kOn = 1e-11;
/// A cluster whose box is nearer to the plane than this, in diagonals of the body, is asked: more than rounding of its box.
constexpr double kRounding = 1e-9;
constexpr double kUlps = 1e-6;  // of how far the body is from the origin: its coordinates are rounded by 1e-16 of that
constexpr std::size_t kCluster = 64;  // triangles
/// A vertex is moved by at most this part of the smallest height around it, so that no triangle comes near to turning over.
constexpr double kFarthestMove = 2.5 * kSnap;
/// Points of a hole that are asked which loop is around it.
constexpr std::size_t kSamples = 7;

using Vec2 = Eigen::Vector2d;

/// A side of a loop between nodes: vertices of the body, then its edges.
struct Side {
    std::int32_t from = 0, to = 0;
    SectionSide along;
};

struct Loop {
    std::vector<SectionPoint> points;
    std::vector<SectionSide> sides;
    std::vector<Vec2> flat;
    double area = 0.0;  // positive around the body, negative around a hole
};

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool contains(const std::vector<Vec2>& loop, const Vec2& p) {
    bool inside = false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) && (cross(b - a, p - a) > 0.0) == (b.y() > a.y())) inside = !inside;
    }
    return inside;
}

double distanceTo(const std::vector<Vec2>& loop, const Vec2& p) {
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 a = loop[i], side = loop[(i + 1) % loop.size()] - a;
        const double squared = side.squaredNorm();
        const double t = squared > 0.0 ? std::clamp(side.dot(p - a) / squared, 0.0, 1.0) : 0.0;
        nearest = std::min(nearest, (a + t * side - p).norm());
    }
    return nearest;
}

class Finder {
public:
    Finder(const CutSurface& surface, const CutPlane& plane) : surface_(surface), mesh_(surface.mesh) {
        normal_ = plane.normal.stableNormalized();
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(normal_[k]) < std::abs(normal_[axis])) axis = k;
        axes_.col(0) = (Vec3::Unit(axis) - normal_[axis] * normal_).normalized();
        axes_.col(1) = normal_.cross(axes_.col(0));
        middle_ = surface.box.low + 0.5 * surface.box.size();
        offset_ = normal_.dot(middle_ - plane.origin);
        origin_ = axes_.transpose() * (plane.origin - middle_);
        const auto vertices = static_cast<std::size_t>(mesh_.vertices.rows());
        distance_ = std::make_unique_for_overwrite<double[]>(vertices);
        released_.assign(vertices, 0);
        side_.assign(vertices, 1);
        // Where a cluster is on one side, with what lies on the plane by tolerance, nothing is asked of it: neither its triangles nor, over an edge on the plane, its neighbours.
        std::vector<char> seen(vertices, 0);
        for (const CutSurface::Cluster& cluster : surface.clusters) {
            const double reach = normal_.cwiseAbs().dot(cluster.half) + kSnap * cluster.height + kRounding * (surface.diagonal + kUlps * cluster.middle.cwiseAbs().sum());
            if (std::abs(distanceOf(cluster.middle)) > reach) continue;
            for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
                crossed_.push_back(surface.byPlace[i]);
                for (int k = 0; k < 3; ++k) {
                    const std::int32_t v = mesh_.triangles(crossed_.back(), k);
                    if (std::exchange(seen[static_cast<std::size_t>(v)], 1) != 0) continue;
                    near_.push_back(v);
                    distance_[static_cast<std::size_t>(v)] = distanceOf(mesh_.vertices.row(v).transpose());
                }
            }
        }
        std::sort(crossed_.begin(), crossed_.end());
        std::sort(near_.begin(), near_.end());
    }

    Result<Section> find() {
        // A vertex that must not be moved is released, and all is found again: each round releases at least one.
        while (true) {
            classify();
            findSides();
            if (sides_.empty()) return fail("no-section", "The plane does not cross the body; move it into the body.");
            findLoops();
            std::vector<std::size_t> chosen = choose();
            if (chosen.empty())
                return fail("section-touches-itself", "The plane only touches the body or crosses it where it is turned inside out; move the plane a little.");
            bool stuck = false;
            std::vector<std::int32_t> release = pinches(chosen, stuck);
            if (stuck)
                return fail("section-touches-itself",
                            "The section touches itself in a point, so that the pieces would hang together there; move or turn the plane a little.");
            std::vector<std::pair<std::int32_t, Vec3>> moved;
            if (release.empty()) moved = moves(chosen, release);
            if (release.empty()) {
                moveTipsBack(chosen, moved);
                return sectionOf(chosen, std::move(moved));
            }
            for (const std::int32_t v : release) released_[static_cast<std::size_t>(v)] = 1;
        }
    }

private:
    [[nodiscard]] double distanceOf(const Vec3& p) const { return normal_.dot(p - middle_) + offset_; }
    [[nodiscard]] bool exact(std::int32_t v) const { return std::abs(distance_[static_cast<std::size_t>(v)]) <= kOn * surface_.diagonal; }
    [[nodiscard]] Vec2 flat(const Vec3& p) const { return axes_.transpose() * (p - middle_); }

    void classify() {
        for (const std::int32_t near : near_) {
            const auto v = static_cast<std::size_t>(near);
            const double d = distance_[v];
            const bool on = std::abs(d) <= kOn * surface_.diagonal || (released_[v] == 0 && std::abs(d) <= kSnap * surface_.height[v]);
            side_[v] = static_cast<std::int8_t>(on ? 0 : d > 0.0 ? 1 : -1);
        }
    }

    [[nodiscard]] int sideOf(std::int32_t f, int k) const { return side_[static_cast<std::size_t>(mesh_.triangles(f, k % 3))]; }

    /// 1: in front of the plane, -1: behind, 0: crosses it. A triangle in the plane belongs to the body that it bounds.
    [[nodiscard]] int sideOf(std::int32_t f) const {
        int front = 0, back = 0;
        for (int k = 0; k < 3; ++k) front += sideOf(f, k) > 0, back += sideOf(f, k) < 0;
        if (front > 0 && back > 0) return 0;
        if (front > 0) return 1;
        if (back > 0) return -1;
        return areaVector(mesh_, f).dot(normal_) > 0.0 ? -1 : 1;
    }

    void findSides() {
        sides_.clear();
        const auto vertices = static_cast<std::int32_t>(mesh_.vertices.rows());
        for (const std::int32_t f : crossed_) {
            const int side = sideOf(f);
            if (side == 0) {
                Side s;
                s.along.triangle = f;
                for (int k = 0; k < 3; ++k) {
                    // Around the front part, the loop leaves where the triangle goes to the back and returns where it comes to the front.
                    const int here = sideOf(f, k), next = sideOf(f, k + 1), before = sideOf(f, k + 2);
                    if (here * next < 0) (here > 0 ? s.from : s.to) = vertices + surface_.edges.edgeOf(f, k);
                    if (here == 0) (before > 0 ? s.from : s.to) = mesh_.triangles(f, k);
                }
                sides_.push_back(s);
            } else if (side > 0) {
                for (int k = 0; k < 3; ++k) {
                    if (sideOf(f, k) != 0 || sideOf(f, k + 1) != 0) continue;
                    const int e = surface_.edges.edgeOf(f, k);
                    const auto uses = surface_.edges.uses(e);
                    if (sideOf(uses[0].triangle == f ? uses[1].triangle : uses[0].triangle) >= 0) continue;
                    Side s;
                    s.from = mesh_.triangles(f, k);
                    s.to = mesh_.triangles(f, (k + 1) % 3);
                    s.along.edge = e;
                    sides_.push_back(s);
                }
            }
        }
    }

    [[nodiscard]] SectionPoint pointOf(std::int32_t node) const {
        SectionPoint point;
        const auto vertices = static_cast<std::int32_t>(mesh_.vertices.rows());
        if (node < vertices) {
            point.vertex = node;
            point.place = mesh_.vertices.row(node).transpose();
            return point;
        }
        point.edge = node - vertices;
        const EdgeUse& use = surface_.edges.uses(point.edge)[0];
        const double low = distance_[static_cast<std::size_t>(use.low)], high = distance_[static_cast<std::size_t>(use.high)];
        point.along = low / (low - high);
        const Vec3 a = mesh_.vertices.row(use.low).transpose(), b = mesh_.vertices.row(use.high).transpose();
        point.place = onPlane(a + point.along * (b - a));
        return point;
    }

    [[nodiscard]] Vec3 onPlane(const Vec3& p) const { return p - distanceOf(p) * normal_; }

    void findLoops() {
        loops_.clear();
        pinched_.clear();
        std::unordered_map<std::int32_t, std::vector<std::size_t>> from;
        for (std::size_t i = sides_.size(); i-- > 0;) from[sides_[i].from].push_back(i);  // lowest last, where it is taken
        for (const auto& [node, out] : from)
            if (out.size() > 1) pinched_.insert({node, out.size()});
        std::vector<char> used(sides_.size(), 0);
        for (std::size_t first = 0; first < sides_.size(); ++first) {
            if (used[first] != 0) continue;
            Loop loop;
            for (std::size_t i = first; used[i] == 0;) {
                used[i] = 1;
                loop.points.push_back(pointOf(sides_[i].from));
                loop.sides.push_back(sides_[i].along);
                loop.flat.push_back(flat(loop.points.back().place));
                for (const std::size_t next : from[sides_[i].to])
                    if (used[next] == 0 || next == first) i = next;
            }
            for (std::size_t i = 1; i + 1 < loop.flat.size(); ++i) loop.area += 0.5 * cross(loop.flat[i] - loop.flat[0], loop.flat[i + 1] - loop.flat[0]);
            loops_.push_back(std::move(loop));
        }
    }

    /// The outer loop of the section meant, then its holes.
    [[nodiscard]] std::vector<std::size_t> choose() const {
        std::vector<std::vector<std::size_t>> holes(loops_.size());
        for (std::size_t h = 0; h < loops_.size(); ++h) {
            if (loops_[h].area >= 0.0) continue;
            std::size_t around = loops_.size();
            for (std::size_t o = 0; o < loops_.size(); ++o)
                if (loops_[o].area > -loops_[h].area && (around == loops_.size() || loops_[o].area < loops_[around].area) && liesIn(loops_[h], loops_[o]))
                    around = o;
            if (around < loops_.size()) holes[around].push_back(h);
        }
        std::vector<std::size_t> chosen;
        double nearest = HUGE_VAL;
        for (std::size_t o = 0; o < loops_.size(); ++o) {
            if (!(loops_[o].area > 0.0)) continue;
            bool inside = contains(loops_[o].flat, origin_);
            double distance = distanceTo(loops_[o].flat, origin_);
            for (const std::size_t h : holes[o]) {
                inside = inside && !contains(loops_[h].flat, origin_);
                distance = std::min(distance, distanceTo(loops_[h].flat, origin_));
            }
            if (inside) distance = 0.0;
            // Of bodies that overlap there, the larger one.
            if (distance < nearest || (distance == nearest && loops_[o].area > loops_[chosen[0]].area)) {
                nearest = distance;
                chosen = {o};
                chosen.insert(chosen.end(), holes[o].begin(), holes[o].end());
            }
        }
        return chosen;
    }

    [[nodiscard]] static bool liesIn(const Loop& inner, const Loop& outer) {
        int inside = 0;
        for (std::size_t i = 0; i < kSamples; ++i) inside += contains(outer.flat, inner.flat[inner.flat.size() * i / kSamples]) ? 1 : -1;
        return inside > 0;
    }

    /// Vertices where more than two sides meet; `stuck`: one of them is on the plane without being moved.
    [[nodiscard]] std::vector<std::int32_t> pinches(const std::vector<std::size_t>& chosen, bool& stuck) const {
        std::vector<std::int32_t> result;
        for (const std::size_t l : chosen)
            for (const SectionPoint& point : loops_[l].points) {
                if (point.vertex < 0 || !pinched_.contains(point.vertex)) continue;
                stuck = stuck || exact(point.vertex);
                result.push_back(point.vertex);
            }
        return result;
    }

    /// Slides the vertices of the loops onto the plane, one after the other: down to it, and within it so far that the volume of the body stays, which is
    /// linear in the place of one vertex. `release` gets those that would move too far.
    [[nodiscard]] std::vector<std::pair<std::int32_t, Vec3>> moves(const std::vector<std::size_t>& chosen, std::vector<std::int32_t>& release) const {
        std::vector<std::pair<std::int32_t, Vec3>> moved;
        for (const std::size_t l : chosen)
            for (const SectionPoint& point : loops_[l].points)
                if (point.vertex >= 0 && !exact(point.vertex)) moved.emplace_back(point.vertex, point.place);
        std::sort(moved.begin(), moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        std::unordered_map<std::int32_t, Vec3> now;
        const auto placeOf = [&](std::int32_t v) -> Vec3 {
            const auto it = now.find(v);
            return it == now.end() ? Vec3(mesh_.vertices.row(v).transpose()) : it->second;
        };
        for (auto& [v, place] : moved) {
            Vec3 gradient = Vec3::Zero();
            for (const std::int32_t corner : surface_.corners.at(v)) {
                const std::int32_t f = corner / 3;
                gradient += (placeOf(mesh_.triangles(f, (corner + 1) % 3)) - place).cross(placeOf(mesh_.triangles(f, (corner + 2) % 3)) - place);
            }
            const double across = gradient.dot(normal_), d = distance_[static_cast<std::size_t>(v)];
            const Vec3 within = gradient - across * normal_;
            const double farthest = kFarthestMove * surface_.height[static_cast<std::size_t>(v)];
            // |move|^2 = d^2 (1 + across^2 / within^2)
            if (!(d * d * (within.squaredNorm() + across * across) <= farthest * farthest * within.squaredNorm()) || !(within.squaredNorm() > 0.0)) {
                release.push_back(v);
                continue;
            }
            place = onPlane(place + (d * across / within.squaredNorm()) * within);
            now[v] = place;
        }
        return moved;
    }

    /// A tip of the surface that ends at the plane within the section, or just beyond it, would pierce the cap: it is moved back to its own side. `moved` stays ascending.
    void moveTipsBack(const std::vector<std::size_t>& chosen, std::vector<std::pair<std::int32_t, Vec3>>& moved) const {
        const auto cutThrough = static_cast<std::ptrdiff_t>(moved.size());
        for (const std::int32_t v : near_) {
            if (side_[static_cast<std::size_t>(v)] != 0 || exact(v)) continue;  // a plane in which a wall lies is taken as it is
            bool front = false, behind = false, cut = false;
            for (const std::int32_t corner : surface_.corners.at(v))
                for (int k = 1; k < 3; ++k) {
                    const int side = sideOf(corner / 3, corner % 3 + k);
                    front = front || side > 0;
                    behind = behind || side < 0;
                }
            if (front == behind) continue;
            const Vec3 place = mesh_.vertices.row(v).transpose();
            const Vec2 at = flat(place);
            bool inside = contains(loops_[chosen[0]].flat, at);
            for (std::size_t l = 0; l < chosen.size(); ++l) {
                inside = inside && (l == 0 || !contains(loops_[chosen[l]].flat, at));
                cut = cut || std::any_of(loops_[chosen[l]].points.begin(), loops_[chosen[l]].points.end(), [v](const SectionPoint& point) { return point.vertex == v; });
            }
            if (inside && !cut) moved.emplace_back(v, onPlane(place) + (front ? kSnap : -kSnap) * surface_.height[static_cast<std::size_t>(v)] * normal_);
        }
        std::inplace_merge(moved.begin(), moved.begin() + cutThrough, moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    }

    [[nodiscard]] Section sectionOf(const std::vector<std::size_t>& chosen, std::vector<std::pair<std::int32_t, Vec3>> moved) {
        Section section;
        section.normal = normal_;
        section.axes = axes_;
        double length = 0.0;
        int count = 0;
        for (const std::size_t l : chosen) {
            Loop& loop = loops_[l];
            for (SectionPoint& point : loop.points) {
                if (point.vertex < 0) continue;
                const auto at = std::lower_bound(moved.begin(), moved.end(), point.vertex, [](const auto& m, std::int32_t v) { return m.first < v; });
                if (at != moved.end() && at->first == point.vertex) point.place = at->second;
            }
            for (const SectionSide& side : loop.sides) {
                const std::int32_t f = side.triangle >= 0 ? side.triangle : surface_.edges.uses(side.edge)[0].triangle;
                for (int k = 0; k < 3; ++k) length += (mesh_.vertices.row(mesh_.triangles(f, k)) - mesh_.vertices.row(mesh_.triangles(f, (k + 1) % 3))).norm();
                count += 3;
            }
            section.loops.push_back(std::move(loop.points));
            section.sides.push_back(std::move(loop.sides));
        }
        section.spacing = length / count;
        section.moved = std::move(moved);
        return section;
    }

    const CutSurface& surface_;
    const TriangleMesh& mesh_;
    Vec3 normal_, middle_;
    Eigen::Matrix<double, 3, 2> axes_;
    double offset_ = 0.0;
    Vec2 origin_;
    std::vector<std::int32_t> crossed_;   // triangles of clusters that the plane crosses, ascending
    std::vector<std::int32_t> near_;      // their vertices, ascending
    std::unique_ptr<double[]> distance_;  // of these alone
    std::vector<std::int8_t> side_;       // 1 in front, 0 on the plane, -1 behind; of these alone
    std::vector<char> released_;     // vertices that must not be moved
    std::vector<Side> sides_;
    std::unordered_map<std::int32_t, std::size_t> pinched_;  // vertices with as many sides that leave them
    std::vector<Loop> loops_;
};

}  // namespace

CutSurface::CutSurface(const TriangleMesh& body)
    : mesh(body), edges(body.triangles), corners(body), diagonal(diagonalOf(body.vertices)), volume(enclosedVolume(body.vertices, body.triangles)), box(boundsOf(body.vertices)) {
    height.assign(static_cast<std::size_t>(mesh.vertices.rows()), HUGE_VAL);
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        double longest = 0.0;
        for (int k = 0; k < 3; ++k)
            longest = std::max(longest, (mesh.vertices.row(mesh.triangles(f, k)) - mesh.vertices.row(mesh.triangles(f, (k + 1) % 3))).norm());
        const double h = longest > 0.0 ? areaVector(mesh, f).norm() / longest : 0.0;
        for (int k = 0; k < 3; ++k) {
            double& least = height[static_cast<std::size_t>(mesh.triangles(f, k))];
            least = std::min(least, h);
        }
    }
    byPlace = trianglesByPlace(mesh);
    for (std::size_t begin = 0; begin < byPlace.size(); begin += kCluster) {
        Cluster& cluster = clusters.emplace_back();
        cluster.begin = begin;
        cluster.end = std::min(begin + kCluster, byPlace.size());
        Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
        for (std::size_t i = begin; i < cluster.end; ++i)
            for (int k = 0; k < 3; ++k) {
                const std::int32_t v = mesh.triangles(byPlace[i], k);
                const Vec3 p = mesh.vertices.row(v).transpose();
                low = low.cwiseMin(p);
                high = high.cwiseMax(p);
                cluster.height = std::max(cluster.height, height[static_cast<std::size_t>(v)]);
            }
        cluster.middle = low + 0.5 * (high - low);
        cluster.half = 0.5 * (high - low);
    }
}

Result<Section> findSection(const CutSurface& surface, const CutPlane& plane) {
    if (!allFinite(plane.origin) || !allFinite(plane.normal) || !(plane.normal.cwiseAbs().maxCoeff() > 0.0) ||
        plane.origin.cwiseAbs().maxCoeff() > kMaxCoordinate)
        return fail("bad-value", "The plane needs an origin within 1e9 m and a normal that is finite and not zero.");
    return Finder(surface, plane).find();
}

}  // namespace imomushi
