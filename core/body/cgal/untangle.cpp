// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/untangle.h"

#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Random.h>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"

namespace imomushi {

namespace pmp = CGAL::Polygon_mesh_processing;

std::optional<TriangleMesh> untangled(const TriangleMesh& mesh) {
    const FloatingPointGuard guard;
    try {
        CGAL::get_default_random() = CGAL::Random(0);
        cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
        if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows())) return std::nullopt;
        if (!pmp::experimental::remove_self_intersections(surface, CGAL::parameters::preserve_genus(true).apply_per_connected_component(false))) return std::nullopt;
        return cgal::toTriangleMesh(surface);
    } catch (const std::exception&) {  // CGAL's preconditions
        return std::nullopt;
    }
}

}  // namespace imomushi
