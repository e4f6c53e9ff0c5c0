// SPDX-License-Identifier: GPL-3.0-or-later
// The finite elements that answers are compared with: exact where they must be, and equal to the given references.
#include "tests/support/finite_elements.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tests/support/reference_case.h"

using namespace imomushi;
namespace fe = imomushi::finite_elements;

namespace {

const std::string kFolder = std::string(IMOMUSHI_TEST_DATA) + "/reference";

/// The bar 0...1 x 0...1 x 0...2, six tetrahedra per cell, inner nodes out of order. Faces: z = 0 and z = 2, or the whole surface.
fe::QuadraticTets bar(bool wholeSurface) {
    constexpr std::int32_t kX = 3, kY = 2, kZ = 4;
    const auto node = [](std::int32_t i, std::int32_t j, std::int32_t k) { return (k * (kY + 1) + j) * (kX + 1) + i; };
    Points points((kX + 1) * (kY + 1) * (kZ + 1), 3);
    std::mt19937_64 bits(3);
    const auto random = [&] { return 0.12 * (static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0); };
    for (std::int32_t k = 0; k <= kZ; ++k)
        for (std::int32_t j = 0; j <= kY; ++j)
            for (std::int32_t i = 0; i <= kX; ++i) {
                points.row(node(i, j, k)) << static_cast<double>(i) / kX, static_cast<double>(j) / kY, 2.0 * k / kZ;
                if (i % kX && j % kY && k % kZ) points.row(node(i, j, k)) += Eigen::RowVector3d(random(), random(), random());
            }
    std::vector<std::int32_t> corners;
    std::vector<std::vector<std::int32_t>> sides(wholeSurface ? 1 : 2);
    const std::array<std::array<int, 3>, 6> orders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (std::int32_t k = 0; k < kZ; ++k)
        for (std::int32_t j = 0; j < kY; ++j)
            for (std::int32_t i = 0; i < kX; ++i)
                for (const auto& order : orders) {
                    std::array<std::int32_t, 3> at{i, j, k};
                    std::array<std::array<std::int32_t, 3>, 4> path{at, at, at, at};
                    for (std::size_t s = 0; s < 3; ++s) {
                        ++at[static_cast<std::size_t>(order[s])];
                        path[s + 1] = at;
                    }
                    std::array<std::int32_t, 4> tet{};
                    for (std::size_t c = 0; c < 4; ++c) tet[c] = node(path[c][0], path[c][1], path[c][2]);
                    corners.insert(corners.end(), tet.begin(), tet.end());
                    for (std::size_t out = 0; out < 4; ++out)
                        for (std::size_t axis = 0; axis < 3; ++axis)
                            for (const std::int32_t plane : {0, axis == 0 ? kX : axis == 1 ? kY : kZ}) {
                                bool on = true;
                                for (std::size_t c = 0; c < 4; ++c) on = on && (c == out || path[c][axis] == plane);
                                if (!on || (!wholeSurface && axis != 2)) continue;
                                auto& side = sides[wholeSurface || plane == 0 ? 0 : 1];
                                for (std::size_t c = 0; c < 4; ++c)
                                    if (c != out) side.push_back(tet[c]);
                            }
                }
    std::vector<Triangles> faces;
    for (auto& side : sides) faces.push_back(Eigen::Map<Triangles>(side.data(), static_cast<Eigen::Index>(side.size() / 3), 3));
    using Tets = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;
    return fe::quadraticTets(points, Eigen::Map<Tets>(corners.data(), static_cast<Eigen::Index>(corners.size() / 4), 4), faces);
}

/// The largest error anywhere when the held nodes follow `exact`, relative to the largest displacement.
double worst(const fe::QuadraticTets& mesh, double nu, const std::function<Vec3(const Vec3&)>& exact) {
    Points expected(mesh.nodes.rows(), 3);
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) expected.row(i) = exact(mesh.nodes.row(i).transpose()).transpose();
    Points held = Points::Zero(mesh.nodes.rows(), 3);
    for (const auto& face : mesh.nodesOfFace)
        for (const std::int32_t node : face) held.row(node) = expected.row(node);
    auto solver = fe::Elastostatics::build(mesh, nu);
    REQUIRE(solver);
    const auto solution = solver->solve(std::array<Points, 1>{held});
    REQUIRE(solution);
    return (solution->displacement[0] - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

/// Rounding times a condition number that is below 1e4 for meshes as small as these.
constexpr double kExact = 1e-10;

double volumeOf(const fe::QuadraticTets& mesh) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
        const auto corner = [&](int c) -> Vec3 { return mesh.nodes.row(mesh.tets(t, c)); };
        const double six = (corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(corner(3) - corner(0));
        CHECK(six > 0.0);
        sum += six / 6.0;
    }
    return sum;
}

double volumeOf(const TriangleMesh& body) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const auto corner = [&](int c) -> Vec3 { return body.vertices.row(body.triangles(t, c)); };
        sum += corner(0).cross(corner(1)).dot(corner(2)) / 6.0;
    }
    return sum;
}

/// Coarse enough for a test that runs in seconds.
fe::Grading grading(const ReferenceBody& body) {
    double size = 1e300;
    for (const JointFace& face : body.faces) size = std::min(size, std::sqrt(face.area / std::numbers::pi));
    return {.rim = 0.025 * size, .crease = 0.3 * size, .bulk = 0.5 * size, .growth = 0.7};
}

}  // namespace

TEST_CASE("finite elements: any constant strain of the whole surface is the strain inside") {
    Eigen::Matrix3d gradient;
    gradient << 0.1, -0.3, 0.2, 0.05, 0.4, -0.1, 0.7, 0.02, -0.2;
    for (const double nu : {0.0, 0.3, 0.45})
        CHECK(worst(bar(true), nu, [&](const Vec3& p) -> Vec3 { return gradient * p + Vec3(1, 2, 3); }) < kExact);
}

TEST_CASE("finite elements: a rigid motion of the ends moves the bar rigidly") {
    CHECK(worst(bar(false), 0.3, [](const Vec3& p) -> Vec3 { return Vec3(1, -2, 0.5) + Vec3(0.3, 0.1, -0.7).cross(p); }) < kExact);
}

TEST_CASE("finite elements: ends that draw the bar out evenly leave its sides free of traction") {
    for (const double nu : {0.3, 0.45})
        CHECK(worst(bar(false), nu, [&](const Vec3& p) -> Vec3 { return Vec3(-nu * p.x(), -nu * p.y(), p.z()); }) < kExact);
}

TEST_CASE("finite elements: pure bending, quadratic, is reproduced exactly") {
    for (const double nu : {0.3, 0.45})
        CHECK(worst(bar(false), nu, [&](const Vec3& p) -> Vec3 {
                  const double x = p.x(), y = p.y(), z = p.z();
                  return {-0.5 * (z * z + nu * (x * x - y * y)), -nu * x * y, x * z};
              }) < kExact);
}

TEST_CASE("finite elements: tetrahedra fill exactly the body, keep its vertices and hold exactly its faces") {
    for (const char* name : {"c_barrel_coarse", "i_hollow_elbow_coarse"}) {
        const ReferenceBody body = readReferenceBody(kFolder, name);
        const auto mesh = fe::meshBody(body.mesh->body, body.faces, grading(body));
        REQUIRE_MESSAGE(mesh, mesh.error().message);
        CHECK(mesh->nodesOfFace.size() >= 2);
        CHECK(volumeOf(*mesh) == doctest::Approx(volumeOf(body.mesh->body)).epsilon(1e-10));
        for (std::size_t v = 0; v < mesh->nodeOfVertex.size(); ++v)
            CHECK((mesh->nodes.row(mesh->nodeOfVertex[v]) - body.mesh->body.vertices.row(static_cast<Eigen::Index>(v))).norm() < 1e-12);
        for (std::size_t f = 0; f < body.faces.size(); ++f) {
            for (const std::int32_t v : body.faces[f].vertices)
                CHECK(std::binary_search(mesh->nodesOfFace[f].begin(), mesh->nodesOfFace[f].end(),
                                         mesh->nodeOfVertex[static_cast<std::size_t>(v)]));
            for (const std::int32_t node : mesh->nodesOfFace[f])
                CHECK(std::abs(body.faces[f].frame.toLocal(mesh->nodes.row(node).transpose()).z()) < 1e-8);
        }
    }
}

TEST_CASE("finite elements: the given references are met, on meshes of our own") {
    // Their stated errors (README.md of the folder), and as much again for this coarse mesh.
    for (const auto& [name, bound] : {std::pair<std::string, double>{"a_cylinder_coarse", 0.0026}, {"c_barrel_coarse", 0.007}}) {
        const ReferenceBody body = readReferenceBody(kFolder, name);
        const auto mesh = fe::meshBody(body.mesh->body, body.faces, grading(body));
        REQUIRE_MESSAGE(mesh, mesh.error().message);
        auto solver = fe::Elastostatics::build(*mesh, 0.3);
        REQUIRE_MESSAGE(solver, solver.error().message);
        for (const ReferenceCase& wanted : readReferenceCases(kFolder, name)) {
            if (wanted.nu != 0.3 || wanted.name == "asym") continue;
            const auto solution = solver->solve(std::array<Points, 1>{faceDisplacement(body, wanted, mesh->nodes, mesh->nodesOfFace)});
            REQUIRE(solution);
            CHECK(solution->residual < 1e-12);
            const ReferenceError error = referenceError(body, mesh->atVertices(solution->displacement[0]), wanted.displacement);
            MESSAGE(name, " ", wanted.name, ": ", 100.0 * error.relative, " % from the reference, ", solver->unknowns(), " unknowns");
            CHECK(error.relative < bound);
        }
    }
}
