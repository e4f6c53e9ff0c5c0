// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

#include "core/mesh/mesh.h"

// Boxes that begin at the same place are sorted by the order in which they were made. CGAL sorts them by address, so that the order of intersections, and with it their numbers and
// triangles, would depend on the heap.
namespace CGAL::Box_intersection_d {
template <>
class Box_d<double, 3, ID_FROM_BOX_ADDRESS> : public Box_d<double, 3, ID_EXPLICIT> {
public:
    using Box_d<double, 3, ID_EXPLICIT>::Box_d;
};
}  // namespace CGAL::Box_intersection_d

// Of the .cpp files of this folder alone.
namespace imomushi::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// A manifold mesh with evenly wound triangles, vertex by vertex.
inline SurfaceMesh toSurfaceMesh(const TriangleMesh& mesh) {
    SurfaceMesh out;
    out.reserve(static_cast<SurfaceMesh::size_type>(mesh.vertices.rows()), static_cast<SurfaceMesh::size_type>(mesh.triangles.rows() * 3 / 2),
                static_cast<SurfaceMesh::size_type>(mesh.triangles.rows()));
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        out.add_vertex(Kernel::Point_3(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)));
    const auto vertex = [&](Eigen::Index f, int k) { return SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(mesh.triangles(f, k))); };
    for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) out.add_face(vertex(f, 0), vertex(f, 1), vertex(f, 2));
    return out;
}

inline TriangleMesh toTriangleMesh(const SurfaceMesh& mesh) {
    TriangleMesh out;
    out.vertices.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
    out.triangles.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
    std::vector<std::int32_t> number(mesh.number_of_vertices() + mesh.number_of_removed_vertices(), -1);
    std::int32_t n = 0;
    for (const auto v : mesh.vertices()) {
        const Kernel::Point_3& p = mesh.point(v);
        out.vertices.row(n) << p.x(), p.y(), p.z();
        number[v] = n++;
    }
    Eigen::Index f = 0;
    for (const auto face : mesh.faces()) {
        int k = 0;
        for (const auto v : mesh.vertices_around_face(mesh.halfedge(face))) out.triangles(f, k++) = number[v];
        ++f;
    }
    return out;
}

}  // namespace imomushi::cgal
