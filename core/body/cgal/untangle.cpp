// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/untangle.h"

#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Random.h>

#include <cmath>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"
#include "core/mesh/topology.h"

namespace imomushi {

namespace pmp = CGAL::Polygon_mesh_processing;

/// Change of volume, relative, that untangling may bring.
constexpr double kVolumeChanged = 0.01;

std::optional<TriangleMesh> untangled(const TriangleMesh& mesh) {
    const FloatingPointGuard guard;
    try {
        CGAL::get_default_random() = CGAL::Random(0);
        cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
        if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows())) return std::nullopt;
        // Where surfaces meet in a vertex alone it looks for a face of one in the fan of the other, for ever.
        pmp::duplicate_non_manifold_vertices(surface);
        if (!pmp::experimental::remove_self_intersections(surface, CGAL::parameters::preserve_genus(true).apply_per_connected_component(false))) return std::nullopt;
        TriangleMesh out = cgal::toTriangleMesh(surface);
        const double before = enclosedVolume(mesh.vertices, mesh.triangles), after = enclosedVolume(out.vertices, out.triangles);
        if (!(std::abs(after - before) <= kVolumeChanged * before)) return std::nullopt;
        return out;
    } catch (const std::exception&) {  // CGAL's preconditions
        return std::nullopt;
    }
}

}  // namespace imomushi
