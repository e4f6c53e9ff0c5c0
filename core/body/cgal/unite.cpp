// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/unite.h"

#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/shape_predicates.h>
#include <CGAL/boost/graph/Euler_operations.h>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"

namespace imomushi {

namespace pmp = CGAL::Polygon_mesh_processing;

namespace {

/// Without triangles that have no area: CGAL's predicates refuse them, and what they meet their neighbours meet too.
cgal::SurfaceMesh withArea(const TriangleMesh& mesh) {
    cgal::SurfaceMesh out = cgal::toSurfaceMesh(mesh);
    for (const auto face : out.faces())
        if (pmp::is_degenerate_triangle_face(face, out)) CGAL::Euler::remove_face(out.halfedge(face), out);
    return out;
}

}  // namespace

bool surfacesMeet(const TriangleMesh& a, const TriangleMesh& b) {
    const FloatingPointGuard guard;
    return pmp::do_intersect(withArea(a), withArea(b));
}

std::optional<TriangleMesh> unite(const TriangleMesh& a, const TriangleMesh& b) {
    const FloatingPointGuard guard;
    cgal::SurfaceMesh first = cgal::toSurfaceMesh(a), second = cgal::toSurfaceMesh(b), both;
    if (first.number_of_faces() != static_cast<std::size_t>(a.triangles.rows()) || second.number_of_faces() != static_cast<std::size_t>(b.triangles.rows()))
        return std::nullopt;
    try {
        if (!pmp::corefine_and_compute_union(first, second, both, CGAL::parameters::throw_on_self_intersection(true))) return std::nullopt;
    } catch (const std::exception&) {  // crossings with themselves, and CGAL's preconditions
        return std::nullopt;
    }
    return cgal::toTriangleMesh(both);
}

}  // namespace imomushi
