// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cgal/unite.h"

#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Random.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/shape_predicates.h>
#include <CGAL/boost/graph/Euler_operations.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/base/floating_point_guard.h"
#include "core/body/cgal/surface_mesh.h"
#include "core/mesh/topology.h"
#include "core/mesh/winding_number.h"

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

/// Two surfaces that meet in edges and triangles of both alone, with vertices in common: one at each place.
struct Conforming {
    Points places;
    std::array<Triangles, 2> triangles;
    std::array<std::vector<char>, 2> walls;  ///< per side of a triangle, 3 f + k: the surfaces meet in it
};

/// Splits triangles of both where they meet. None where one is no manifold; throws where one crosses itself.
std::optional<Conforming> conforming(const TriangleMesh& a, const TriangleMesh& b) {
    // In which order CGAL finds what meets follows from its random numbers; they begin anew, so that what was done before does not matter.
    CGAL::get_default_random() = CGAL::Random(0);
    std::array<cgal::SurfaceMesh, 2> mesh{cgal::toSurfaceMesh(a), cgal::toSurfaceMesh(b)};
    if (mesh[0].number_of_faces() != static_cast<std::size_t>(a.triangles.rows()) || mesh[1].number_of_faces() != static_cast<std::size_t>(b.triangles.rows()))
        return std::nullopt;
    std::array<cgal::SurfaceMesh::Property_map<cgal::SurfaceMesh::Edge_index, bool>, 2> meets;
    for (std::size_t m = 0; m < 2; ++m) meets[m] = mesh[m].add_property_map<cgal::SurfaceMesh::Edge_index, bool>("e:meets", false).first;
    pmp::corefine(mesh[0], mesh[1], CGAL::parameters::throw_on_self_intersection(true).edge_is_constrained_map(meets[0]),
                  CGAL::parameters::edge_is_constrained_map(meets[1]));
    Conforming out;
    std::map<std::array<double, 3>, std::int32_t> numbers;
    for (std::size_t m = 0; m < 2; ++m) {
        std::vector<std::array<std::int32_t, 3>> triangles;
        for (const auto face : mesh[m].faces()) {
            auto& t = triangles.emplace_back();
            std::size_t k = 0;
            for (const auto h : mesh[m].halfedges_around_face(mesh[m].halfedge(face))) {
                const auto& p = mesh[m].point(mesh[m].source(h));
                t[k++] = numbers.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::int32_t>(numbers.size())).first->second;
                out.walls[m].push_back(get(meets[m], mesh[m].edge(h)));
            }
        }
        out.triangles[m].resize(static_cast<Eigen::Index>(triangles.size()), 3);
        for (std::size_t f = 0; f < triangles.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k)
                out.triangles[m](static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = triangles[f][k];
    }
    out.places.resize(static_cast<Eigen::Index>(numbers.size()), 3);
    for (const auto& [place, number] : numbers) out.places.row(number) << place[0], place[1], place[2];
    return out;
}

/// A triangle by its corners, the lowest one first; the other way round where `turned`.
std::array<std::int32_t, 3> cornersOf(const Triangles& triangles, Eigen::Index f, bool turned) {
    std::array<std::int32_t, 3> c{triangles(f, 0), triangles(f, turned ? 2 : 1), triangles(f, turned ? 1 : 2)};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    return c;
}

enum class Lying { Free, Alike, Opposite };

/// How the triangles of surface m lie on those of the other one.
std::vector<Lying> lyingOn(const Conforming& both, std::size_t m) {
    std::vector<std::array<std::int32_t, 3>> other;
    for (Eigen::Index f = 0; f < both.triangles[1 - m].rows(); ++f) other.push_back(cornersOf(both.triangles[1 - m], f, false));
    std::sort(other.begin(), other.end());
    std::vector<Lying> lying;
    for (Eigen::Index f = 0; f < both.triangles[m].rows(); ++f) {
        const auto has = [&](bool turned) {
            return std::binary_search(other.begin(), other.end(), cornersOf(both.triangles[m], f, turned));
        };
        lying.push_back(has(false) ? Lying::Alike : has(true) ? Lying::Opposite : Lying::Free);
    }
    return lying;
}

/// The union of surfaces some of whose triangles lie on each other: those that look the same way are one, those that look against each other are none, and of the
/// others, in patches between the edges where the surfaces meet, those outside of the other body stay. Where flesh touches in an edge or a vertex alone, so
/// does the surface.
TriangleMesh unitedByPatches(const Conforming& both, const std::array<std::vector<Lying>, 2>& lying,
                             const std::array<const TriangleMesh*, 2>& body) {
    std::vector<std::array<std::int32_t, 3>> kept;
    for (std::size_t m = 0; m < 2; ++m) {
        const Triangles& triangles = both.triangles[m];
        const EdgeTable edges(triangles);
        const TriangleMesh here{both.places, triangles};
        std::vector<char> seen(lying[m].size(), 0);
        const auto keep = [&](std::int32_t f) { kept.push_back({triangles(f, 0), triangles(f, 1), triangles(f, 2)}); };
        for (std::size_t first = 0; first < seen.size(); ++first) {
            if (seen[first] != 0) continue;
            if (lying[m][first] != Lying::Free) {
                if (m == 0 && lying[m][first] == Lying::Alike) keep(static_cast<std::int32_t>(first));
                continue;
            }
            std::vector<std::int32_t> patch{static_cast<std::int32_t>(first)};
            seen[first] = 1;
            for (std::size_t i = 0; i < patch.size(); ++i)
                for (int k = 0; k < 3; ++k) {
                    if (both.walls[m][3 * static_cast<std::size_t>(patch[i]) + static_cast<std::size_t>(k)] != 0) continue;
                    for (const EdgeUse& use : edges.uses(edges.edgeOf(patch[i], k)))
                        if (char& s = seen[static_cast<std::size_t>(use.triangle)];
                            s == 0 && lying[m][static_cast<std::size_t>(use.triangle)] == Lying::Free)
                            s = 1, patch.push_back(use.triangle);
                }
            // Its largest triangle is asked: the middle of a thin one may be no farther from the other surface than rounding.
            std::int32_t largest = patch[0];
            for (const std::int32_t f : patch)
                if (areaVector(here, f).squaredNorm() > areaVector(here, largest).squaredNorm()) largest = f;
            const Vec3 middle =
                (both.places.row(triangles(largest, 0)) + both.places.row(triangles(largest, 1)) + both.places.row(triangles(largest, 2)))
                    .transpose() /
                3.0;
            if (windingNumber(*body[1 - m], middle) > 0.5) continue;
            for (const std::int32_t f : patch) keep(f);
        }
    }
    TriangleMesh out;
    std::vector<std::int32_t> number(static_cast<std::size_t>(both.places.rows()), -1);
    std::vector<std::int32_t> used;
    for (auto& t : kept)
        for (std::int32_t& v : t) {
            std::int32_t& n = number[static_cast<std::size_t>(v)];
            if (n < 0) n = static_cast<std::int32_t>(used.size()), used.push_back(v);
            v = n;
        }
    out.vertices = both.places(used, Eigen::all);
    out.triangles.resize(static_cast<Eigen::Index>(kept.size()), 3);
    for (std::size_t f = 0; f < kept.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) out.triangles(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = kept[f][k];
    return out;
}

}  // namespace

bool surfacesMeet(const TriangleMesh& a, const TriangleMesh& b) {
    const FloatingPointGuard guard;
    return pmp::do_intersect(withArea(a), withArea(b));
}

std::optional<TriangleMesh> unite(const TriangleMesh& a, const TriangleMesh& b) {
    const FloatingPointGuard guard;
    try {
        // CGAL's own union does not end for some surfaces that touch: it walks around vertices in which its result hangs together.
        const std::optional<Conforming> both = conforming(a, b);
        if (!both) return std::nullopt;
        TriangleMesh whole = unitedByPatches(*both, {lyingOn(*both, 0), lyingOn(*both, 1)}, {&a, &b});
        if (whole.triangles.rows() == 0) return std::nullopt;
        return whole;
    } catch (const std::exception&) {  // crossings with themselves, and CGAL's preconditions
        return std::nullopt;
    }
}

}  // namespace imomushi
