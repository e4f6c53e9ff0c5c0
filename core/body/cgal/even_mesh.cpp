// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/even_mesh.h"

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <cmath>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"
#include "core/body/cgal/vertex_normal.h"

namespace imomushi {
namespace {

constexpr unsigned kRemeshings = 3;

}  // namespace

TriangleMesh evenMesh(const TriangleMesh& mesh, std::size_t vertices) {
    const FloatingPointGuard guard;
    cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
    if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows())) return {};
    try {
        // A vertex of a mesh of equilateral triangles has sqrt(3) / 2 side^2 of the area.
        const double side = std::sqrt(2.0 / std::sqrt(3.0) * CGAL::Polygon_mesh_processing::area(surface) / static_cast<double>(vertices));
        if (!(side > 0.0) || !std::isfinite(side)) return {};
        CGAL::Polygon_mesh_processing::isotropic_remeshing(faces(surface), side, surface, CGAL::parameters::number_of_iterations(kRemeshings));
        surface.collect_garbage();
    } catch (const std::exception&) {  // CGAL's preconditions
        return {};
    }
    return cgal::toTriangleMesh(surface);
}

}  // namespace imomushi
