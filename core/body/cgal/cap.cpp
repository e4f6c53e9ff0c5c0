// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/cap.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/floating_point_guard.h"

namespace imomushi {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kWanted = 15.0 * kDegree;  // smallest angle that is aimed at; Ruppert's method ends for angles up to 20.7 degrees
constexpr double kLargest = 1.5;            // longest side of a triangle, of the spacing wanted, unless that takes more
constexpr double kMostTriangles = 3.0;      // triangles than this per point of the loops: in wide regions they grow inward
/// Points in all, per point of the loops and for small loops, before refinement gives up (walls of no thickness, loops that nearly touch).
constexpr std::size_t kMost = 12, kMostSmall = 4000;
/// Steps of the mesher per point that it may have before it is given up: each adds a point, or finds that none is needed.
constexpr std::size_t kMostSteps = 20;
/// Sides that come nearer to a point of another one than this, in sizes of the region, are not refined: new points lie about as close together as they do, and
/// their coordinates are rounded. Where triangles are much thinner than the rounding of their corners the mesher loses its way, and does not end or crashes.
constexpr double kNearest = 1e-6;

/// The number of a vertex, -1: the mesher made it.
struct Number {
    int value = -1;
};
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Faces = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
                                                       CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Cdt>;

Vec2 placeOf(Cdt::Vertex_handle v) { return {v->point().x(), v->point().y()}; }

double distanceTo(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 side = b - a;
    return (a + std::clamp(side.dot(p - a) / side.squaredNorm(), 0.0, 1.0) * side - p).norm();
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double smallestAngleOf(const std::array<Vec2, 3>& p) {
    double smallest = std::numbers::pi;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
        smallest = std::min(smallest, std::atan2(std::abs(cross(a, b)), a.dot(b)));
    }
    return smallest;
}

std::array<Vec2, 3> cornersOf(Cdt::Face_handle f) { return {placeOf(f->vertex(0)), placeOf(f->vertex(1)), placeOf(f->vertex(2))}; }

class Region {
public:
    Region(const std::vector<std::vector<Vec2>>& loops, double spacing) {
        double twiceArea = 0.0;
        for (const auto& loop : loops) {
            const std::size_t begin = points_.size();
            for (std::size_t i = 0; i < loop.size(); ++i) {
                twiceArea += cross(loop[i] - loops[0][0], loop[(i + 1) % loop.size()] - loops[0][0]);
                points_.push_back(loop[i]);
                next_.push_back(i + 1 < loop.size() ? static_cast<int>(begin + i + 1) : static_cast<int>(begin));
            }
        }
        given_ = points_.size();
        const double equilateral = std::sqrt(3.0) / 4.0;
        longest_ = std::max(kLargest * spacing, std::sqrt(0.5 * std::abs(twiceArea) / (equilateral * kMostTriangles * static_cast<double>(given_))));
    }

    /// False where loops touch or cross.
    bool triangulate() {
        std::vector<Cdt::Vertex_handle> at;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            at.push_back(insert(points_[i]));
            if (at.back()->info().value >= 0) return false;
            at.back()->info().value = static_cast<int>(i);
        }
        try {
            for (std::size_t i = 0; i < given_; ++i) cdt_.insert_constraint(at[i], at[static_cast<std::size_t>(next_[i])]);
        } catch (const Cdt::Intersection_of_constraints_exception&) {
            return false;
        }
        for (std::size_t i = 0; i < given_; ++i) {
            Cdt::Face_handle f;
            int k = 0;
            if (!cdt_.is_edge(at[i], at[static_cast<std::size_t>(next_[i])], f, k) || !f->is_constrained(k)) return false;
        }
        mark();
        return true;
    }

    /// Whether the triangles are good as they are.
    [[nodiscard]] bool good() const {
        for (auto f = cdt_.finite_faces_begin(); f != cdt_.finite_faces_end(); ++f) {
            if (!f->is_in_domain()) continue;
            const std::array<Vec2, 3> p = cornersOf(f);
            const double longest = std::sqrt(std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()}));
            if (smallestAngleOf(p) < kWanted || longest > longest_) return false;
        }
        return true;
    }

    /// Whether all sides of loops keep apart, those that meet at a corner included: there the ends of the two do.
    [[nodiscard]] bool apart() const {
        Vec2 low = points_[0], high = points_[0];
        for (std::size_t i = 0; i < given_; ++i) low = low.cwiseMin(points_[i]), high = high.cwiseMax(points_[i]);
        const double least = kNearest * (high - low).norm();
        std::vector<std::pair<double, std::size_t>> sorted;  // along the longer axis
        const int axis = high.x() - low.x() < high.y() - low.y() ? 1 : 0;
        for (std::size_t i = 0; i < given_; ++i) sorted.emplace_back(points_[i][axis], i);
        std::sort(sorted.begin(), sorted.end());
        for (std::size_t i = 0; i < given_; ++i) {
            const auto end = static_cast<std::size_t>(next_[i]);
            const Vec2 &a = points_[i], &b = points_[end];
            const Vec2 from = (a.cwiseMin(b).array() - least).matrix(), to = (a.cwiseMax(b).array() + least).matrix();
            for (auto p = std::lower_bound(sorted.begin(), sorted.end(), std::pair(from[axis], std::size_t{0}));
                 p != sorted.end() && p->first <= to[axis]; ++p) {
                const Vec2& q = points_[p->second];
                if (p->second == i || p->second == end || q[1 - axis] < from[1 - axis] || q[1 - axis] > to[1 - axis]) continue;
                if (distanceTo(a, b, q) < least) return false;
            }
        }
        return true;
    }

    /// Ruppert's refinement, which splits sides of loops where they are too long for what is near. False where it would need too many points. For sides that
    /// are apart().
    bool refine() {
        const double s = std::sin(kWanted);
        CGAL::Delaunay_mesher_2<Cdt, Criteria> mesher(cdt_, Criteria(s * s, longest_));
        mesher.init(true);
        const std::size_t most = kMost * given_ + kMostSmall;
        for (std::size_t steps = 0; !mesher.is_refinement_done(); ++steps) {
            if (cdt_.number_of_vertices() > most || steps > kMostSteps * most) return false;
            mesher.step_by_step_refine_mesh();
        }
        for (auto v = cdt_.finite_vertices_begin(); v != cdt_.finite_vertices_end(); ++v)
            if (v->info().value < 0) {
                v->info().value = static_cast<int>(points_.size());
                points_.push_back(placeOf(v));
            }
        return true;
    }

    [[nodiscard]] PlaneRegion result() {
        PlaneRegion region;
        region.added.assign(points_.begin() + static_cast<std::ptrdiff_t>(given_), points_.end());
        region.onSide.resize(given_);
        for (auto v = cdt_.finite_vertices_begin(); v != cdt_.finite_vertices_end(); ++v)
            if (v->info().value < static_cast<int>(given_)) followSides(v, region.onSide[static_cast<std::size_t>(v->info().value)]);
        std::vector<std::array<int, 3>> corners;
        region.smallestAngle = std::numbers::pi;
        for (auto f = cdt_.finite_faces_begin(); f != cdt_.finite_faces_end(); ++f) {
            if (!f->is_in_domain()) continue;
            std::array<int, 3> c{f->vertex(0)->info().value, f->vertex(1)->info().value, f->vertex(2)->info().value};
            std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
            corners.push_back(c);
            region.smallestAngle = std::min(region.smallestAngle, smallestAngleOf(cornersOf(f)));
        }
        std::sort(corners.begin(), corners.end());
        region.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
        for (std::size_t f = 0; f < corners.size(); ++f)
            for (int k = 0; k < 3; ++k) region.triangles(static_cast<Eigen::Index>(f), k) = corners[f][static_cast<std::size_t>(k)];
        return region;
    }

private:
    Cdt::Vertex_handle insert(const Vec2& p) { return cdt_.insert(Cdt::Point(p.x(), p.y())); }

    /// Tells triangles inside from those outside and in holes: each loop is one more wall to pass.
    void mark() {
        for (auto f = cdt_.all_faces_begin(); f != cdt_.all_faces_end(); ++f) f->set_in_domain(false);
        std::vector<std::pair<Cdt::Face_handle, bool>> open{{cdt_.infinite_face(), false}};
        CGAL::Unique_hash_map<Cdt::Face_handle, bool> seen(false);
        seen[cdt_.infinite_face()] = true;
        while (!open.empty()) {
            const auto [f, inside] = open.back();
            open.pop_back();
            f->set_in_domain(inside);
            for (int k = 0; k < 3; ++k) {
                const Cdt::Face_handle g = f->neighbor(k);
                if (seen[g]) continue;
                seen[g] = true;
                open.emplace_back(g, inside != f->is_constrained(k));
            }
        }
    }

    /// From point v of a loop along its side: the points added on it.
    void followSides(Cdt::Vertex_handle v, std::vector<std::int32_t>& onSide) const {
        const int end = next_[static_cast<std::size_t>(v->info().value)];
        for (const Cdt::Vertex_handle first : constrainedNeighbours(v)) {
            std::vector<std::int32_t> path;
            Cdt::Vertex_handle before = v, here = first;
            while (here->info().value >= static_cast<int>(given_)) {
                path.push_back(here->info().value);
                const auto around = constrainedNeighbours(here);
                const Cdt::Vertex_handle after = around[0] == before ? around[1] : around[0];
                before = here;
                here = after;
            }
            if (here->info().value == end) {
                onSide = std::move(path);
                return;
            }
        }
    }

    /// Two for each point on a loop.
    [[nodiscard]] std::vector<Cdt::Vertex_handle> constrainedNeighbours(Cdt::Vertex_handle v) const {
        std::vector<Cdt::Vertex_handle> result;
        auto e = cdt_.incident_edges(v);
        const auto begin = e;
        do {
            if (!cdt_.is_infinite(e) && e->first->is_constrained(e->second)) {
                const Cdt::Vertex_handle a = e->first->vertex(Cdt::cw(e->second)), b = e->first->vertex(Cdt::ccw(e->second));
                result.push_back(a == v ? b : a);
            }
        } while (++e != begin);
        return result;
    }

    double longest_ = 0.0;  // side of a triangle
    std::vector<Vec2> points_;
    std::vector<int> next_;
    std::size_t given_ = 0;
    Cdt cdt_;
};

}  // namespace

std::optional<PlaneRegion> meshRegion(const std::vector<std::vector<Vec2>>& loops, double spacing) {
    const FloatingPointGuard guard;
    Region region(loops, spacing);
    if (!region.triangulate()) return std::nullopt;
    if (region.good()) return region.result();
    PlaneRegion plain = region.result();
    if (plain.triangles.rows() == 0 || !region.apart() || !region.refine()) return plain;
    PlaneRegion refined = region.result();
    return refined.smallestAngle >= plain.smallestAngle ? refined : plain;
}

}  // namespace imomushi
