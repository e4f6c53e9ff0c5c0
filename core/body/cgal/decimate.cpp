// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/decimate.h"

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"

namespace imomushi {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;

/// Ends at a number of vertices or when cancelled.
struct Enough {
    std::size_t edges;
    const Progress* progress;
    template <class Cost, class Profile>
    bool operator()(const Cost&, const Profile&, std::size_t, std::size_t current) const {
        return current <= edges || (current % 64 == 0 && progress->cancelled());
    }
};

}  // namespace

TriangleMesh collapseEdges(const TriangleMesh& mesh, std::size_t vertices, const Progress& progress) {
    if (static_cast<std::size_t>(mesh.vertices.rows()) <= vertices) return mesh;
    const FloatingPointGuard guard;
    cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
    if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows())) return mesh;
    sms::edge_collapse(surface, Enough{3 * vertices, &progress},
                       CGAL::parameters::get_cost(sms::LindstromTurk_cost<cgal::SurfaceMesh>())
                           .get_placement(sms::LindstromTurk_placement<cgal::SurfaceMesh>())
                           .filter(sms::Bounded_normal_change_filter<>()));
    return cgal::toTriangleMesh(surface);
}

}  // namespace imomushi
