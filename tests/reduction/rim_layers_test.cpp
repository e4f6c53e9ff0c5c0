// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/rim_layers.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/health.h"
#include "core/meshing/decimation.h"
#include "core/meshing/solved_body.h"
#include "tests/reduction/faces.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

double faceArea(const SolverMesh& mesh, std::size_t f) {
    double area = 0.0;
    for (const std::int32_t t : mesh.faces[f].triangles) {
        const auto row = [&](int c) -> Vec3 { return mesh.mesh.vertices.row(mesh.mesh.triangles(t, c)); };
        area += 0.5 * (row(1) - row(0)).cross(row(2) - row(0)).norm();
    }
    return area;
}

/// The same closed polyhedron as `body`, its vertices first, faces covered exactly, every new vertex where it says.
void checkSameBody(const SolverMesh& mesh, const shapes::Body& body, const std::vector<JointFace>& faces) {
    const MeshFacts before = meshFacts(body.mesh), after = meshFacts(mesh.mesh);
    const Eigen::Index own = body.mesh.vertices.rows();
    CHECK(after.closed);
    CHECK(after.outward == before.outward);
    CHECK(after.volume == doctest::Approx(before.volume).epsilon(1e-12));
    CHECK(after.area == doctest::Approx(before.area).epsilon(1e-12));
    CHECK(mesh.mesh.vertices.topRows(own) == body.mesh.vertices);
    REQUIRE(static_cast<Eigen::Index>(mesh.origin.size()) == mesh.mesh.vertices.rows() - own);
    for (Eigen::Index v = own; v < mesh.mesh.vertices.rows(); ++v) {
        const auto& [of, share] = mesh.origin[static_cast<std::size_t>(v - own)];
        Vec3 p = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(of[k] < v);
            p += share[k] * Vec3(mesh.mesh.vertices.row(of[k]).transpose());
        }
        CHECK((Vec3(mesh.mesh.vertices.row(v).transpose()) - p).norm() <= 1e-14);
    }
    for (std::size_t f = 0; f < faces.size(); ++f) CHECK(faceArea(mesh, f) == doctest::Approx(faces[f].area).epsilon(1e-12));
}

}  // namespace

TEST_CASE("strips: the same closed polyhedron, and as many rows towards the rims as asked for") {
    // The last has faces of one triangle each: all their sides are singular.
    for (const auto& body : {shapes::bar(3), shapes::cylinder(0.5, 2.0, 9, 5), shapes::cylinder(0.5, 2.0, 3, 4)}) {
        const auto faces = facesOf(body);
        const SolverMesh plain = plainSolverMesh(body.mesh, faces);
        Eigen::Index before = plain.mesh.vertices.rows();
        for (const int layers : {2, 3, 5}) {
            const SolverMesh mesh = withLayers(plain, layers);
            checkSameBody(mesh, body, faces);
            CHECK(mesh.mesh.vertices.rows() > before);
            before = mesh.mesh.vertices.rows();
            CHECK(mesh.mesh.triangles == withLayers(plain, layers).mesh.triangles);
        }
        CHECK(withLayers(plain, 1).mesh.vertices == plain.mesh.vertices);
    }
}

TEST_CASE("strips: a rim with n vertices costs a few n vertices per strip, not powers of two of them") {
    const auto body = shapes::cylinder(0.5, 3.0, 24, 12);
    const auto faces = facesOf(body);
    const SolverMesh plain = plainSolverMesh(body.mesh, faces);
    const auto rows = [&](int layers) { return withLayers(plain, layers).mesh.vertices.rows(); };
    // Two rims of 24 vertices; about four sides of triangles leave each.
    CHECK(rows(4) - rows(3) == rows(3) - rows(2));
    CHECK(rows(4) - rows(3) <= 5 * 2 * 24);
}

TEST_CASE("strips: bodies without singular edges and slivers at rims stay as they are") {
    const auto ball = shapes::sphere(1.0, 2);
    CHECK(withLayers(plainSolverMesh(ball.mesh, {}), 3).mesh.triangles == ball.mesh.triangles);
    auto plate = shapes::bar(3);
    const auto faces = facesOf(plate);
    plate.mesh.vertices.col(2) *= 1e-4;  // the rims' neighbours are a thousand times longer than high
    CHECK(withLayers(plainSolverMesh(plate.mesh, faces), 3).mesh.vertices.allFinite());
}

TEST_CASE("halving at bubbles: the same polyhedron with a vertex in the middle of each") {
    const auto body = shapes::cylinder(0.5, 2.0, 9, 5);
    const auto faces = facesOf(body);
    const auto solved = solvedBody(body.mesh, faces, {}, {}, false);
    REQUIRE(solved);
    REQUIRE(!solved->mesh.bubbles.empty());
    const SolverMesh halved = halvedAtBubbles(solved->mesh);
    CHECK(halved.mesh.vertices.rows() == solved->nodes());
    checkSameBody(halved, body, faces);
}

TEST_CASE("solver mesh of a setting for boundary elements: a body of few vertices is refined, one of many is decimated, and the size is known beforehand") {
    const auto few = shapes::bar(2);
    const auto fewFaces = facesOf(few);
    const auto solved = solvedBody(few.mesh, fewFaces, {}, {}, false);
    REQUIRE(solved);
    CHECK(solved->plain.mesh.vertices.rows() >= 350);
    CHECK(!solved->decimated);
    CHECK(solvedSize(few.mesh, fewFaces, {}, false).nodes == solved->nodes());

    const auto many = shapes::cylinder(0.5, 3.0, 40, 60);
    const auto manyFaces = facesOf(many);
    const auto small = solvedBody(many.mesh, manyFaces, {}, {}, false);
    REQUIRE(small);
    CHECK(small->decimated);
    CHECK(std::abs(std::log(static_cast<double>(solvedSize(many.mesh, manyFaces, {}, false).nodes) / small->nodes())) <= std::log(1.5));

    const auto plain = solvedBody(many.mesh, manyFaces, {SolverMeshSetting::Kind::AsIs, 0}, {});
    REQUIRE(plain);
    CHECK(plain->nodes() == many.mesh.vertices.rows());
    CHECK(plain->mesh.bubbles.empty());
}

TEST_CASE("solver mesh of a draft: rims that keep more vertices than a draft has cost no more than themselves") {
    // Saws of 240 vertices around both ends, of which none lies straight between its neighbours.
    auto body = shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 0.5}, 60, 60, 10);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
        auto p = body.mesh.vertices.row(v);
        if (p.z() > 0.0 && p.z() < 0.5) continue;
        for (int k = 0; k < 2; ++k)
            if (std::abs(p[k]) == 0.5 && std::lround((p[1 - k] + 0.5) * 60.0) % 2 == 1) p[k] *= 1.02;
    }
    const auto faces = facesOf(body);
    const auto small = decimate(body.mesh, faces, SolverMeshSetting::kDraftVertices, {});
    REQUIRE(!small);
    CHECK(small.error().code == "too-few-vertices");
    const auto solved = solvedBody(body.mesh, faces, {SolverMeshSetting::Kind::Draft, 0}, {}, false);
    REQUIRE(solved);
    CHECK(solved->decimated);
    CHECK(solved->nodes() < body.mesh.vertices.rows() / 5);
    const auto filled = solvedBody(body.mesh, faces, {SolverMeshSetting::Kind::Draft, 0}, {});
    REQUIRE(filled);
    CHECK(filled->decimated);
    CHECK(filled->filling);
}
