// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Before any function of CGAL's that asks for normals of vertices: it is a specialisation.
#include <CGAL/Polygon_mesh_processing/compute_normal.h>

#include <boost/property_map/property_map.hpp>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "core/body/cgal/surface_mesh.h"

namespace imomushi::cgal {

/// Triangles at a vertex above which CGAL's most visible normal, which takes their number to the power of four, is left out: it tries all triples against all others, minutes in the middle of a
/// disc of 300. Where it has none CGAL takes the mean by angles.
inline constexpr std::size_t kFan = 48;

using FaceNormals = boost::associative_property_map<std::unordered_map<SurfaceMesh::Face_index, Kernel::Vector_3>>;

}  // namespace imomushi::cgal

namespace CGAL::Polygon_mesh_processing::internal {

template <>
inline imomushi::cgal::Kernel::Vector_3 compute_vertex_normal_most_visible_min_circle<imomushi::cgal::SurfaceMesh, imomushi::cgal::FaceNormals, imomushi::cgal::Kernel>(
    boost::graph_traits<imomushi::cgal::SurfaceMesh>::vertex_descriptor v, const imomushi::cgal::FaceNormals& normals, const imomushi::cgal::SurfaceMesh& mesh,
    const imomushi::cgal::Kernel& traits) {
    using Mesh = imomushi::cgal::SurfaceMesh;
    std::vector<Mesh::Face_index> faces;
    for (const auto f : CGAL::faces_around_target(halfedge(v, mesh), mesh))
        if (f != Mesh::null_face()) faces.push_back(f);
    if (faces.size() == 1) return get(normals, faces.front());
    if (faces.size() > imomushi::cgal::kFan) return CGAL::NULL_VECTOR;
    const auto two = compute_most_visible_normal_2_points<Mesh>(faces, normals, traits);
    if (two != CGAL::NULL_VECTOR || faces.size() == 2) return two;
    return compute_most_visible_normal_3_points<Mesh>(faces, normals, traits);
}

}  // namespace CGAL::Polygon_mesh_processing::internal
