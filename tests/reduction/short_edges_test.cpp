// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/short_edges.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/mesh/health.h"
#include "core/mesh/topology.h"
#include "core/meshing/body_surface.h"
#include "core/meshing/volume_body.h"
#include "core/meshing/solver_mesh_setting.h"
#include "tests/reduction/faces.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A leg of long narrow triangles: its tip is a hundred times thinner than its root, and nothing lies between.
shapes::Body leg() {
    shapes::Body leg = shapes::cylinder(0.1, 1.0, 9, 1);
    for (Eigen::Index v = 0; v < leg.mesh.vertices.rows(); ++v) leg.mesh.vertices.row(v).head<2>() *= 1.0 - 0.99 * leg.mesh.vertices(v, 2);
    return leg;
}

/// The least of all edges, each over the longest ones at both of its ends.
double shortestEdge(const TriangleMesh& mesh) {
    const EdgeTable edges(mesh.triangles);
    std::vector<double> longest(static_cast<std::size_t>(mesh.vertices.rows()), 0.0);
    const auto length = [&](int e) { return (mesh.vertices.row(edges.uses(e)[0].low) - mesh.vertices.row(edges.uses(e)[0].high)).norm(); };
    for (int e = 0; e < edges.size(); ++e)
        for (const std::int32_t v : {edges.uses(e)[0].low, edges.uses(e)[0].high}) longest[static_cast<std::size_t>(v)] = std::max(longest[static_cast<std::size_t>(v)], length(e));
    double shortest = 1.0;
    for (int e = 0; e < edges.size(); ++e)
        shortest = std::min(shortest, length(e) / std::min(longest[static_cast<std::size_t>(edges.uses(e)[0].low)], longest[static_cast<std::size_t>(edges.uses(e)[0].high)]));
    return shortest;
}

double areaOf(const SolverMesh& mesh, std::size_t f) {
    double area = 0.0;
    for (const std::int32_t t : mesh.faces[f].triangles) area += 0.5 * areaVector(mesh.mesh, t).norm();
    return area;
}

}  // namespace

TEST_CASE("short edges: bisection makes them in the points of narrow triangles, and they go without a mark on the body") {
    const shapes::Body body = leg();
    const auto faces = facesOf(body);
    const SolverMesh plain = plainSolverMesh(body.mesh, faces);
    std::vector<std::int32_t> label(static_cast<std::size_t>(body.mesh.triangles.rows()), -1);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const std::int32_t t : plain.faces[f].triangles) label[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    std::vector<double> longest;
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) longest.push_back(body.mesh.vertices(v, 2) > 0.5 ? 0.0005 : 0.05);
    const SolverMesh bisected = bisectedTo(body.mesh, label, faces.size(), longest);
    const SolverMesh clean = withoutShortEdges(bisected);
    MESSAGE(bisected.mesh.vertices.rows(), " vertices to ", clean.mesh.vertices.rows(), ", shortest edge over those around it ", shortestEdge(bisected.mesh), ", then ", shortestEdge(clean.mesh));
    CHECK(shortestEdge(bisected.mesh) < 0.001);
    CHECK(shortestEdge(clean.mesh) >= 0.03);  // some would turn a triangle over
    CHECK(clean.mesh.vertices.rows() < bisected.mesh.vertices.rows());

    const MeshFacts facts = meshFacts(clean.mesh);
    CHECK(facts.closed);
    CHECK(facts.outward);
    CHECK(facts.volume == doctest::Approx(meshFacts(body.mesh).volume).epsilon(0.002));
    const Eigen::Index own = body.mesh.vertices.rows();
    CHECK(clean.mesh.vertices.topRows(own) == body.mesh.vertices);
    for (std::size_t f = 0; f < faces.size(); ++f) CHECK(areaOf(clean, f) == doctest::Approx(faces[f].area).epsilon(1e-12));
    REQUIRE(static_cast<Eigen::Index>(clean.origin.size()) == clean.mesh.vertices.rows() - own);
    for (std::size_t i = 0; i < clean.origin.size(); ++i) {
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(clean.origin[i].of[k] < own);
            p += clean.origin[i].share[k] * Vec3(body.mesh.vertices.row(clean.origin[i].of[k]).transpose());
        }
        CHECK((p - Vec3(clean.mesh.vertices.row(own + static_cast<Eigen::Index>(i)).transpose())).norm() < 1e-14);
    }
}

TEST_CASE("short edges: a leg of narrow triangles is filled with tetrahedra and has no such edges") {
    const shapes::Body body = leg();
    const auto faces = facesOf(body);
    const BodySurface surface(body.mesh, faces);
    const auto filled = volumeBody(surface, volumeDetail(body.mesh, faces, parseSolverMesh("draft").value()), {});
    REQUIRE(filled.has_value());
    MESSAGE(filled->mesh.mesh.vertices.rows(), " vertices, ", filled->filling->vertices.rows(), " with those inside, shortest edge ", shortestEdge(filled->mesh.mesh));
    CHECK(shortestEdge(filled->mesh.mesh) >= 0.2 * shortestEdge(body.mesh));
}
