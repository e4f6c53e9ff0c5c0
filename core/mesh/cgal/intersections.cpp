// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/cgal/intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>

#include "core/base/floating_point_guard.h"
#include "core/base/vec3.h"

namespace imomushi {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

Point point(const TriangleMesh& mesh, std::int32_t v) {
    return {mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)};
}

/// Two triangles on one edge meet elsewhere only where they lie on each other.
bool foldedOnto(const Point& a, const Point& b, const Point& c, const Point& d) {
    return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
}

/// Rounding of differences and scalar products of coordinates, many times over.
constexpr double kRounding = 1e-13;

double rounding(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    return kRounding * std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff(), d.cwiseAbs().maxCoeff(), e.cwiseAbs().maxCoeff()});
}

/// c and d clearly lie on different sides of the edge a-b: the usual case, which needs no exact numbers (flat surfaces would need them).
bool clearlyUnfolded(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double length = (b - a).norm();
    if (!(length > 0.0)) return false;
    const Vec3 along = (b - a) / length;
    const Vec3 toC = (c - a) - along * along.dot(c - a), toD = (d - a) - along * along.dot(d - a);
    const double error = rounding(a, b, c, d, a);
    return toC.dot(toD) < -error * (toC.norm() + toD.norm() + error);
}

/// A plane through the common corner s clearly has one triangle on either side.
bool clearlyApart(const Vec3& s, const Vec3& p1, const Vec3& p2, const Vec3& q1, const Vec3& q2) {
    const Vec3 p = p1 - s + (p2 - s), q = q1 - s + (q2 - s);
    const double pLength = p.norm(), qLength = q.norm();
    if (!(pLength > 0.0) || !(qLength > 0.0)) return false;
    const Vec3 normal = p / pLength - q / qLength;  // at most 2 long
    const double error = 2.0 * rounding(s, p1, p2, q1, q2);
    return normal.dot(p1 - s) > error && normal.dot(p2 - s) > error && normal.dot(q1 - s) < -error && normal.dot(q2 - s) < -error;
}

bool meet(const TriangleMesh& mesh, std::int32_t f, std::int32_t g) {
    std::array<std::int32_t, 3> p{}, q{};
    for (int k = 0; k < 3; ++k) p[k] = mesh.triangles(f, k), q[k] = mesh.triangles(g, k);
    std::array<int, 3> inP{}, inQ{};  // corners of p and q that are shared
    int shared = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (p[i] == q[j]) {
                inP[shared] = i;
                inQ[shared] = j;
                if (++shared == 3) return true;
                break;
            }
    const auto at = [&](std::int32_t v) -> Vec3 { return mesh.vertices.row(v); };
    if (shared == 2) {
        const int c = 3 - inP[0] - inP[1], d = 3 - inQ[0] - inQ[1];
        if (clearlyUnfolded(at(p[inP[0]]), at(p[inP[1]]), at(p[c]), at(q[d]))) return false;
        return foldedOnto(point(mesh, p[inP[0]]), point(mesh, p[inP[1]]), point(mesh, p[c]), point(mesh, q[d]));
    }
    if (shared == 1 && clearlyApart(at(p[inP[0]]), at(p[(inP[0] + 1) % 3]), at(p[(inP[0] + 2) % 3]), at(q[(inQ[0] + 1) % 3]), at(q[(inQ[0] + 2) % 3])))
        return false;
    const Kernel::Triangle_3 s(point(mesh, p[0]), point(mesh, p[1]), point(mesh, p[2]));
    const Kernel::Triangle_3 t(point(mesh, q[0]), point(mesh, q[1]), point(mesh, q[2]));
    if (shared == 1) {
        const Kernel::Segment_3 pSide(point(mesh, p[(inP[0] + 1) % 3]), point(mesh, p[(inP[0] + 2) % 3]));
        const Kernel::Segment_3 qSide(point(mesh, q[(inQ[0] + 1) % 3]), point(mesh, q[(inQ[0] + 2) % 3]));
        return CGAL::do_intersect(t, pSide) || CGAL::do_intersect(s, qSide);
    }
    return CGAL::do_intersect(s, t);
}

/// Between looks whether it was cancelled: at most a few milliseconds.
constexpr std::size_t kLook = 4096;

struct Enough {};  // leaves CGAL's sweep early

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> selfIntersections(const TriangleMesh& mesh, std::size_t limit, const Progress& progress) {
    const FloatingPointGuard guard;
    std::vector<Box> boxes;
    boxes.reserve(static_cast<std::size_t>(mesh.triangles.rows()));
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        const Point a = point(mesh, mesh.triangles(f, 0)), b = point(mesh, mesh.triangles(f, 1)), c = point(mesh, mesh.triangles(f, 2));
        if (CGAL::collinear(a, b, c)) continue;
        boxes.emplace_back(a.bbox() + b.bbox() + c.bbox(), f);
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    std::size_t tests = 0;
    const auto test = [&](const Box& x, const Box& y) {
        if (++tests % kLook == 0 && progress.cancelled()) throw Enough{};
        if (!meet(mesh, x.info(), y.info())) return;
        pairs.push_back(std::minmax(x.info(), y.info()));
        if (pairs.size() >= limit) throw Enough{};
    };
    try {
        CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), test);
    } catch (const Enough&) {
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace imomushi
