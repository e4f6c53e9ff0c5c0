// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

Result<JointFace> discAt(const TriangleMesh& body, const Vec3& point, double radius) {
    const SurfacePoint place = nearestOnSurface(body, point);
    return jointFaceByDisc(body, place.triangle, place.point, radius);
}

}  // namespace

TEST_CASE("disc: on a sphere it holds what is within the radius along the surface, and its frame looks outward") {
    const TriangleMesh body = shapes::sphere(1.0, 4).mesh;
    const double radius = 0.5, edge = 0.08;  // of this mesh, about
    for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-1, 2, 0.5)}) {
        const Vec3 d = direction.normalized();
        const auto face = discAt(body, d, radius);
        REQUIRE(face);
        CHECK(!face->flat());
        CHECK(face->frame.axes.col(2).dot(d) > 0.99);
        CHECK(face->frame.axes.determinant() == doctest::Approx(1.0));
        for (const auto v : face->vertices) {
            const double along = std::acos(std::clamp(d.dot(Vec3(body.vertices.row(v).transpose()).normalized()), -1.0, 1.0));
            CHECK(along <= radius + 0.1 * edge);
        }
        // A cap of a sphere, less at most a ring of triangles.
        const double cap = 2.0 * std::numbers::pi * (1.0 - std::cos(radius)), less = 2.0 * std::numbers::pi * (1.0 - std::cos(radius - 2.0 * edge));
        CHECK(face->area <= cap);
        CHECK(face->area >= less);
        // The bases of faces that are not flat have three columns more.
        CHECK(FaceBasis::on(body, *face, BasisKind::Affine).columns() == 12);
    }
}

TEST_CASE("disc: distances run along the surface, so a disc on one side of a thin plate leaves the other side alone") {
    const TriangleMesh plate = shapes::box(Vec3(0, 0, 0), Vec3(4, 4, 0.05), 16, 16, 1).mesh;
    const auto face = discAt(plate, Vec3(2, 2, 0.05), 1.0);
    REQUIRE(face);
    CHECK(face->flat());
    for (const auto v : face->vertices) CHECK(plate.vertices(v, 2) == 0.05);
    CHECK((face->frame.axes.col(2) - Vec3::UnitZ()).norm() < 1e-12);
}

TEST_CASE("disc: where the mesh is coarse it is all triangles at the nearest vertex") {
    const TriangleMesh body = shapes::sphere(1.0, 1).mesh;
    const auto face = discAt(body, Vec3(0.1, 0.2, 1.0), 1e-6);
    REQUIRE(face);
    CHECK(face->triangles.size() >= 4);
    Eigen::Index nearest = 0;
    (body.vertices.rowwise() - nearestOnSurface(body, Vec3(0.1, 0.2, 1.0)).point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    for (const auto t : face->triangles) CHECK((body.triangles.row(t).array() == nearest).any());
}

TEST_CASE("disc: one that closes around a limb, or that cannot be, is refused with the reason") {
    const TriangleMesh limb = shapes::cylinder(0.2, 6.0, 12, 40).mesh;
    const auto small = discAt(limb, Vec3(0.2, 0, 3), 0.3), around = discAt(limb, Vec3(0.2, 0, 3), 1.0);
    CHECK(small.has_value());
    REQUIRE(!around);
    CHECK(around.error().code == "not-a-disc");
    CHECK(jointFaceByDisc(limb, -1, Vec3::Zero(), 1.0).error().code == "bad-index");
    CHECK(jointFaceByDisc(limb, 0, Vec3::Zero(), 0.0).error().code == "bad-value");
    CHECK(jointFaceByDisc(limb, 0, Vec3(std::nan(""), 0, 0), 1.0).error().code == "bad-value");
}

TEST_CASE("disc: over a tip it goes round as far as there is an outward side") {
    const TriangleMesh body = shapes::sphere(1.0, 3).mesh;
    const auto half = discAt(body, Vec3(0, 0, 1), 0.5 * std::numbers::pi);
    REQUIRE(half);
    CHECK(half->frame.axes.col(2).z() > 0.99);
    CHECK(discAt(body, Vec3(0, 0, 1), 10.0).error().code == "not-a-disc");  // all of it
}

TEST_CASE("disc: faces that share a vertex are found") {
    const TriangleMesh body = shapes::sphere(1.0, 3).mesh;
    const auto a = discAt(body, Vec3(0, 0, 1), 0.4), b = discAt(body, Vec3(0, 0.5, 1), 0.4), c = discAt(body, Vec3(0, 0, -1), 0.4);
    REQUIRE(a);
    REQUIRE(b);
    REQUIRE(c);
    const std::vector<JointFace> faces = {*c, *a};
    CHECK(overlappingFace(faces, *b) == 1);
    CHECK(overlappingFace(std::span(faces).first(1), *b) == -1);
}
