// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/disc_mesh.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/mesh/topology.h"
#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

JointFace handleAt(const TriangleMesh& body, const Vec3& point, double radius, const char* name) {
    const SurfacePoint place = nearestOnSurface(body, point);
    JointFace face = jointFaceByDisc(body, place.triangle, place.point, radius).value();
    face.name = name;
    face.disc = SurfaceDisc{place.point, radius};
    return face;
}

/// A ball of radius 1, turned so that its triangles lie otherwise.
TriangleMesh ball(int level, double turn) {
    TriangleMesh mesh = shapes::sphere(1.0, level).mesh;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    mesh.vertices = (mesh.vertices * R.transpose()).eval();
    return mesh;
}

double areaOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles) {
    double sum = 0.0;
    for (const std::int32_t t : triangles) sum += 0.5 * areaVector(mesh, t).norm();
    return sum;
}

ResponseInput twoHandles(const TriangleMesh& mesh, double radius) {
    ResponseInput input;
    const auto element = std::make_shared<ElementMesh>();
    element->body = mesh;
    input.mesh = element;
    input.faces = {handleAt(mesh, Vec3(0, 0, 1), radius, "top"), handleAt(mesh, Vec3(0, 0, -1), radius, "bottom")};
    input.basis = BasisKind::Affine;
    input.solverMesh = parseSolverMesh("decimated:250").value();
    input.threads = 2;
    return input;
}

/// The work of moving the first handle along `direction`, the other one held.
double workOf(const ResponseInput& input, const ElementResponse& response, const Vec3& direction) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
    // The columns of a basis are linear in the place: least squares from the vertices of the face.
    const FaceBasis& basis = response.bases[0];
    const JointFace& face = input.faces[0];
    Eigen::MatrixXd C(3 * static_cast<Eigen::Index>(face.vertices.size()), basis.columns());
    Eigen::VectorXd moved(C.rows());
    for (std::size_t i = 0; i < face.vertices.size(); ++i) {
        C.middleRows(3 * static_cast<Eigen::Index>(i), 3) = face.frame.axes * basis.at(face.frame.toLocal(input.mesh->body.vertices.row(face.vertices[i]).transpose()));
        moved.segment<3>(3 * static_cast<Eigen::Index>(i)) = direction;
    }
    v.head(basis.columns()) = (C.transpose() * C).ldlt().solve(C.transpose() * moved);
    return 0.5 * v.dot(response.stiffness * v);
}

}  // namespace

TEST_CASE("disc mesh: a disc has its area whatever the triangles, on the same polyhedron") {
    const double radius = 0.5, cap = 2.0 * std::numbers::pi * (1.0 - std::cos(radius));
    for (const auto& [level, turn] : {std::pair(3, 0.0), {3, 0.7}, {4, 0.0}, {4, 1.9}}) {
        const TriangleMesh body = ball(level, turn);
        const std::vector<JointFace> faces = {handleAt(body, Vec3(0, 0, 1), radius, "top"), handleAt(body, Vec3(1, 0, 0), radius, "side")};
        const DiscMesh cut = discMesh(body, faces);
        REQUIRE(cut.any());
        const TriangleMesh& mesh = cut.mesh.mesh;
        CHECK(mesh.vertices.topRows(body.vertices.rows()) == body.vertices);
        CHECK(surfaceArea(mesh) == doctest::Approx(surfaceArea(body)).epsilon(1e-12));
        for (std::size_t f = 0; f < faces.size(); ++f) {
            CHECK(cut.exact[f] != 0);
            const double area = areaOf(mesh, cut.mesh.faces[f].triangles);
            MESSAGE("ball of ", body.vertices.rows(), " vertices: the disc has ", 100.0 * area / cap, " % of the cap, its triangles ", 100.0 * faces[f].area / cap, " %");
            // Distances along the surface are good to a few percent, the polyhedron of 642 vertices lies within its ball, and rims are polygons.
            CHECK(area == doctest::Approx(cap).epsilon(0.04));
            CHECK(std::abs(area - cap) < 0.5 * std::abs(faces[f].area - cap));
            for (const std::int32_t v : faces[f].vertices) CHECK(std::binary_search(cut.mesh.faces[f].vertices.begin(), cut.mesh.faces[f].vertices.end(), v));
        }
    }
}

TEST_CASE("disc mesh: discs that would come near another face, and what a coarse mesh has instead of a disc, keep their triangles") {
    const TriangleMesh body = ball(4, 0.0);
    const std::vector<JointFace> near = {handleAt(body, Vec3(0, 0, 1), 0.4, "a"), handleAt(body, Vec3(0, std::sin(0.85), std::cos(0.85)), 0.4, "b")};
    REQUIRE(overlappingFace(std::span(near).first(1), near[1]) == -1);
    CHECK(!discMesh(body, near).any());
    const TriangleMesh coarse = ball(1, 0.0);
    CHECK(!discMesh(coarse, std::vector{handleAt(coarse, Vec3(0, 0, 1), 0.05, "a")}).any());
    std::vector<JointFace> plain = {handleAt(body, Vec3(0, 0, 1), 0.4, "a")};
    plain[0].disc.reset();
    CHECK(!discMesh(body, plain).any());
}

TEST_CASE("disc mesh: what lies in a disc beside its triangles moves with the handle") {
    const ResponseInput input = twoHandles(ball(4, 0.4), 0.5);
    const DiscMesh cut = discMesh(input.mesh->body, input.faces);
    REQUIRE(!cut.inside.empty());
    const auto response = buildResponse(input, {});
    REQUIRE(response);
    for (const DiscMesh::Inside& in : cut.inside) {
        const auto at = std::lower_bound(response->freeVertices.begin(), response->freeVertices.end(), in.vertex);
        REQUIRE(*at == in.vertex);
        const auto f = static_cast<std::size_t>(in.face);
        const FaceFrame& frame = input.faces[f].frame;
        const Eigen::MatrixXd moved = frame.axes * response->bases[f].at(frame.toLocal(input.mesh->body.vertices.row(in.vertex).transpose()));
        const Eigen::MatrixXd row = response->response.middleRows(3 * (at - response->freeVertices.begin()), 3);
        CHECK((row.middleCols(response->firstColumn[f], moved.cols()) - moved).norm() < 1e-12);
        CHECK(row.norm() == doctest::Approx(moved.norm()));  // and with no other
    }
}

TEST_CASE("disc mesh: the work that moves a handle does not depend on the triangles of the body") {
    const double radius = 0.4;
    std::vector<double> ofDiscs, ofTriangles;
    for (const auto& [level, turn] : {std::pair(3, 0.0), {4, 0.7}}) {
        ResponseInput input = twoHandles(ball(level, turn), radius);
        const auto exact = buildResponse(input, {});
        REQUIRE(exact);
        ofDiscs.push_back(workOf(input, *exact, Vec3::UnitZ()));
        for (JointFace& face : input.faces) face.disc.reset();
        const auto snapped = buildResponse(input, {});
        REQUIRE(snapped);
        ofTriangles.push_back(workOf(input, *snapped, Vec3::UnitZ()));
    }
    const double byDiscs = std::abs(ofDiscs[0] / ofDiscs[1] - 1.0), byTriangles = std::abs(ofTriangles[0] / ofTriangles[1] - 1.0);
    MESSAGE("balls of 642 and 2,562 vertices differ by ", 100.0 * byDiscs, " % with discs, ", 100.0 * byTriangles, " % with triangles");
    // Areas may differ by some percent, and the work grows like their square root; polyhedra of the two balls differ by 1 %.
    CHECK(byDiscs < 0.04);
    CHECK(byDiscs < byTriangles);
}
