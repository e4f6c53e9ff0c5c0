// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/cgal/fill_hole.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "core/base/floating_point_guard.h"

namespace imomushi {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Vertices of a polygon up to which all of its triangulations are compared where Delaunay has none: cubic, a tenth of a second for these.
constexpr Eigen::Index kLargestCubic = 300;

struct Corners {
    std::array<std::int32_t, 3> at{};
    Corners(int a, int b, int c) : at{a, b, c} {}
};

}  // namespace

std::vector<std::array<std::int32_t, 3>> triangulateHole(const Points& polygon) {
    const FloatingPointGuard guard;
    std::vector<Kernel::Point_3> points;
    for (Eigen::Index i = 0; i < polygon.rows(); ++i) points.emplace_back(polygon(i, 0), polygon(i, 1), polygon(i, 2));
    std::vector<Corners> triangles;
    try {
        CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
            points, std::back_inserter(triangles),
            CGAL::parameters::use_delaunay_triangulation(true).use_2d_constrained_delaunay_triangulation(true).do_not_use_cubic_algorithm(
                polygon.rows() > kLargestCubic));
    } catch (const std::exception&) {  // CGAL's preconditions, on polygons that cross themselves
        triangles.clear();
    }
    std::vector<std::array<std::int32_t, 3>> result;
    for (const Corners& t : triangles) result.push_back(t.at);
    return result;
}

}  // namespace imomushi
