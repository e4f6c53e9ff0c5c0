// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>

#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A unit cube with corners at 0 and 1, moved by `shift`; vertex index = x + 2 y + 4 z.
TriangleMesh cube(const Vec3& shift = Vec3::Zero()) {
    TriangleMesh mesh;
    mesh.vertices.resize(8, 3);
    for (int i = 0; i < 8; ++i) mesh.vertices.row(i) = (Vec3(i & 1, i >> 1 & 1, i >> 2 & 1) + shift).transpose();
    mesh.triangles.resize(12, 3);
    mesh.triangles << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
    return mesh;
}

double uniform(double low, double high) {
    return low + (high - low) * *rc::gen::inRange(0, 1'000'001) / 1e6;
}

}  // namespace

TEST_CASE("joint face by plane: the frame follows the stated rule on every side of a cube, far from the origin too") {
    for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(1e6, -2e6, 3e6)})
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const Vec3 z = side * Vec3::Unit(axis);
                const Vec3 centre = shift + Vec3::Constant(0.5) + 0.5 * z;
                const auto face = jointFaceByPlane(cube(shift), centre, 3.0 * z, 1e-6);
                REQUIRE(face);
                CHECK(face->vertices.size() == 4);
                CHECK(face->triangles.size() == 2);
                CHECK(face->area == doctest::Approx(1.0));
                CHECK((face->frame.origin - centre).norm() <= 1e-9);
                CHECK((face->frame.axes.col(2) - z).norm() <= 1e-12);
                // Both other axes are equally far from the normal: the earlier one is x.
                CHECK((face->frame.axes.col(0) - Vec3::Unit(axis == 0 ? 1 : 0)).norm() <= 1e-12);
                CHECK(face->frame.axes.determinant() == doctest::Approx(1.0));
                CHECK(face->flat());
            }
}

TEST_CASE("joint face by plane: a plane beside the body, or facing inward, finds nothing and says so") {
    CHECK(jointFaceByPlane(cube(), Vec3(0, 0, 2), Vec3(0, 0, 1), 1e-6).error().code == "no-patch");
    CHECK(jointFaceByPlane(cube(), Vec3(0, 0, 1), Vec3(0, 0, -1), 1e-6).error().code == "no-patch");
    CHECK(jointFaceByPlane(cube(), Vec3(0, 0, 1), Vec3(0, 0, 0), 1e-6).error().code == "bad-value");
    CHECK(jointFaceByPlane(cube(), Vec3(0, 0, 1), Vec3(0, 0, 1), -1.0).error().code == "bad-value");
    CHECK(jointFaceByPlane(cube(), Vec3(NAN, 0, 1), Vec3(0, 0, 1), 1e-6).error().code == "bad-value");
}

TEST_CASE("joint face by vertices: the triangles whose corners are all named; strays and separate patches are refused") {
    const auto face = jointFaceByVertices(cube(), {7, 5, 6, 4});
    REQUIRE(face);
    CHECK(face->vertices == std::vector<std::int32_t>{4, 5, 6, 7});
    CHECK(face->triangles == std::vector<std::int32_t>{2, 3});
    CHECK(face->planarityError <= 1e-15);
    CHECK(jointFaceByVertices(cube(), {0, 1}).error().code == "no-patch");
    CHECK(jointFaceByVertices(cube(), {0, 1, 8}).error().code == "bad-index");
    CHECK(jointFaceByVertices(cube(), {0, 1, -1}).error().code == "bad-index");
    CHECK(jointFaceByVertices(cube(), {1, 2, 0, 7}).error().code == "not-connected");
    CHECK(jointFaceByVertices(cube(), {0, 1, 2, 3, 4, 5, 6, 7}).error().code == "not-planar");
}

TEST_CASE("joint face by seed: one side of the cube, whichever of its triangles was clicked") {
    for (std::int32_t t = 0; t < 12; ++t) {
        const auto face = jointFaceBySeed(cube(), EdgeTable(cube().triangles), t, 0.2, 1e-6);
        REQUIRE(face);
        CHECK(face->triangles == std::vector<std::int32_t>{t / 2 * 2, t / 2 * 2 + 1});
    }
    CHECK(jointFaceBySeed(cube(), EdgeTable(cube().triangles), 12, 0.2, 1e-6).error().code == "bad-index");
}

TEST_CASE("eq. (5): with a = b = 1 the map is a rigid tilt about an axis in the plane, and its columns are the displaced axes") {
    CHECK(rc::check([] {
        PaperParameters p;
        p.theta1 = uniform(-3.0, 3.0), p.theta2 = uniform(-1.5, 1.5);
        const JointMap map = jointMap(p);
        RC_ASSERT((map.linear.transpose() * map.linear - Eigen::Matrix3d::Identity()).norm() < 1e-13);
        // The axis across theta1 stays where it is.
        const Vec3 across(-std::sin(p.theta1), std::cos(p.theta1), 0.0);
        RC_ASSERT((map.linear * across - across).norm() < 1e-13);
    }));
}

TEST_CASE("basis: both bases say eq. (5) exactly, affine says every affine map of the plane, and curved faces every one of space") {
    CHECK(rc::check([] {
        const Vec3 p(uniform(-1, 1), uniform(-1, 1), 0.0);
        const JointMap paper = jointMap({uniform(0.5, 2), uniform(0.5, 2), uniform(-3, 3), uniform(-1.4, 1.4), uniform(-1, 1)});
        JointMap any;
        for (int i = 0; i < 9; ++i) any.linear.data()[i] = uniform(-2, 2);
        any.shift = Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        const auto error = [](const FaceBasis& basis, const JointMap& map, const Vec3& at) {
            Eigen::VectorXd v(basis.columns());
            double lost = -1.0;
            basis.coefficients(map, 1.0, v.data(), lost);
            RC_ASSERT(lost >= 0.0);
            return (at + basis.at(at) * v - (map.linear * at + map.shift)).norm();
        };
        RC_ASSERT(error({BasisKind::Paper, true}, paper, p) < 1e-14 * 10);
        RC_ASSERT(error({BasisKind::Affine, true}, any, p) < 1e-14 * 10);
        const Vec3 outside(p.x(), p.y(), uniform(-0.2, 0.2));
        RC_ASSERT(error({BasisKind::Affine, false}, any, outside) < 1e-14 * 10);
        RC_ASSERT(error({BasisKind::Paper, false}, paper, outside) < 1e-14 * 10);
    }));
}

TEST_CASE("paper basis: a twist is left out and told, and the plane neither shrinks nor tilts because of it") {
    const FaceBasis basis{BasisKind::Paper, true};
    JointMap map = jointMap({1.0, 1.0, 0.4, 0.3, 0.0});
    const Eigen::Matrix3d tilt = map.linear;
    map.linear = tilt * Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
    map.shift = Vec3(0.1, 0.0, 0.0);
    Eigen::VectorXd v(6);
    double lost = 0.0;
    basis.coefficients(map, 2.0, v.data(), lost);
    CHECK(lost == doctest::Approx(0.7));
    Eigen::VectorXd without(6);
    double none = 1.0;
    basis.coefficients({tilt, Vec3::Zero()}, 2.0, without.data(), none);
    CHECK(none <= 1e-15);
    CHECK((v - without).norm() <= 1e-14);
}

TEST_CASE("warping: no mode moves, tilts, twists or stretches a face in the mean, and all of them move it about as far as a unit of stretch") {
    const auto body = shapes::cylinder(0.3, 1.0, 24, 4);
    const JointFace face = jointFaceByVertices(body.mesh, body.ends[1].vertices).value();
    const FaceBasis basis = FaceBasis::on(body.mesh, face, {BasisKind::Modes, 36});
    REQUIRE(basis.columns() == 45);
    // Integrals of what is linear on triangles.
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(45, 45);
    for (const auto t : face.triangles) {
        std::array<Eigen::MatrixXd, 3> u;
        for (int c = 0; c < 3; ++c) u[c] = basis.at(face.frame.toLocal(body.mesh.vertices.row(body.mesh.triangles(t, c)).transpose()));
        const double share = areaVector(body.mesh, t).norm() / (24.0 * face.area);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) products += (a == b ? 2.0 : 1.0) * share * u[a].transpose() * u[b];
    }
    const double unit = products(0, 0);
    CHECK(products.block(0, 9, 9, 36).cwiseAbs().maxCoeff() < 1e-12 * 9);
    for (int i = 9; i < 45; ++i) CHECK((products(i, i) == 0.0 || std::abs(products(i, i) / unit - 1.0) < 0.1));
}

TEST_CASE("warping: two tessellations of one face say the same eleven columns' displacements") {
    const auto body = shapes::box(Vec3::Zero(), Vec3(1.0, 0.6, 1.0), 4, 3, 2), other = shapes::box(Vec3::Zero(), Vec3(1.0, 0.6, 1.0), 5, 4, 2);
    const FaceBasis a = FaceBasis::on(body.mesh, jointFaceByVertices(body.mesh, body.ends[1].vertices).value(), {BasisKind::Modes, 11});
    const FaceBasis b = FaceBasis::on(other.mesh, jointFaceByVertices(other.mesh, other.ends[1].vertices).value(), {BasisKind::Modes, 11});
    Eigen::MatrixXd atA(3 * 49, 20), atB(3 * 49, 20);
    for (int i = 0; i < 7; ++i)
        for (int k = 0; k < 7; ++k) {
            const Vec3 p((i - 3) / 6.0, 0.6 * (k - 3) / 6.0, 0.0);
            atA.middleRows<3>(3 * (7 * i + k)) = a.at(p);
            atB.middleRows<3>(3 * (7 * i + k)) = b.at(p);
        }
    CHECK((atA * atA.colPivHouseholderQr().solve(atB) - atB).norm() < 1e-10 * atB.norm());
    CHECK((atB * atB.colPivHouseholderQr().solve(atA) - atA).norm() < 1e-10 * atA.norm());
}

TEST_CASE("basis names: known ones go both ways, others are refused with the ones there are") {
    for (const auto kind : {BasisKind::Paper, BasisKind::Affine, BasisKind::Full}) CHECK(parseBasis(basisName(kind)).value() == kind);
    for (int count = 1; count <= 36; ++count) CHECK(parseBasis("modes:" + std::to_string(count)).value() == BasisChoice(BasisKind::Modes, count));
    CHECK(basisName({BasisKind::Modes, 12}) == "modes:12");
    for (const char* bad : {"full9", "modes", "modes:", "modes:0", "modes:37", "modes:-3", "modes:1.5", "modes:12 ", "modes: 12", "modes:x", "modes:99999999999"})
        CHECK(parseBasis(bad).error().code == "bad-value");
}
