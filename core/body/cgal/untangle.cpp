// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/untangle.h"

#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"
#include "core/body/cgal/vertex_normal.h"
#include "core/mesh/topology.h"
#include "core/mesh/winding_tree.h"

namespace imomushi {

namespace pmp = CGAL::Polygon_mesh_processing;

/// Change of volume, relative, that untangling may bring.
constexpr double kVolumeChanged = 0.01;
/// How far beside a triangle its two sides are looked at, over the root of twice its area.
constexpr double kAside = 1e-4;

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

std::optional<TriangleMesh> outerSide(const TriangleMesh& mesh) {
    const FloatingPointGuard guard;
    try {
        CGAL::get_default_random() = CGAL::Random(0);
        cgal::SurfaceMesh surface = cgal::toSurfaceMesh(mesh);
        if (surface.number_of_faces() != static_cast<std::size_t>(mesh.triangles.rows())) return std::nullopt;
        pmp::duplicate_non_manifold_vertices(surface);
        pmp::experimental::autorefine(surface);
        const TriangleMesh split = cgal::toTriangleMesh(surface);
        std::map<std::array<double, 3>, std::int32_t> places;
        std::vector<std::int32_t> placeOf;
        for (Eigen::Index v = 0; v < split.vertices.rows(); ++v) {
            const std::array<double, 3> place{split.vertices(v, 0), split.vertices(v, 1), split.vertices(v, 2)};
            placeOf.push_back(places.try_emplace(place, static_cast<std::int32_t>(v)).first->second);
        }
        // A triangle is of the outer side where the surface winds around what lies behind it, and not around what lies before it: half of the jump at the triangle itself.
        const WindingTree winding(mesh);
        std::vector<std::array<std::int32_t, 3>> kept;
        for (Eigen::Index f = 0; f < split.triangles.rows(); ++f) {
            std::array<std::int32_t, 3> t{};
            for (int k = 0; k < 3; ++k) t[static_cast<std::size_t>(k)] = placeOf[static_cast<std::size_t>(split.triangles(f, k))];
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
            const Eigen::RowVector3d a = split.vertices.row(t[0]), b = split.vertices.row(t[1]), c = split.vertices.row(t[2]);
            const Eigen::RowVector3d normal = (b - a).cross(c - a);
            const double twice = normal.norm();
            if (!(twice > 0.0)) continue;
            const double step = kAside * std::sqrt(twice);
            const Vec3 middle = ((a + b + c) / 3.0).transpose(), aside = step / twice * normal.transpose();
            if (winding.at(middle + aside) < 0.5 && winding.at(middle - aside) > 0.5) kept.push_back(t);
        }
        if (kept.empty()) return std::nullopt;
        TriangleMesh out;
        std::vector<std::int32_t> number(static_cast<std::size_t>(split.vertices.rows()), -1);
        for (const auto& t : kept)
            for (const std::int32_t v : t) number[static_cast<std::size_t>(v)] = 0;
        std::int32_t used = 0;
        for (std::int32_t& n : number)
            if (n == 0) n = used++;
        out.vertices.resize(used, 3);
        for (std::size_t v = 0; v < number.size(); ++v)
            if (number[v] >= 0) out.vertices.row(number[v]) = split.vertices.row(static_cast<Eigen::Index>(v));
        out.triangles.resize(static_cast<Eigen::Index>(kept.size()), 3);
        for (std::size_t f = 0; f < kept.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) out.triangles(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = number[static_cast<std::size_t>(kept[f][k])];
        return out;
    } catch (const std::exception&) {  // CGAL's preconditions
        return std::nullopt;
    }
}

}  // namespace imomushi
