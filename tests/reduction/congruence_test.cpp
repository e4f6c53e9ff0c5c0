// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/congruence.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

ResponseInput inputOf(const TriangleMesh& body, const std::vector<shapes::Patch>& ends, BasisKind basis = BasisKind::Affine) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body;
    ResponseInput input;
    input.mesh = mesh;
    for (const shapes::Patch& end : ends) {
        auto face = jointFaceByVertices(body, end.vertices);
        REQUIRE(face);
        input.faces.push_back(*face);
    }
    input.basis = basis;
    input.nu = 0.4;
    input.solverMesh.kind = SolverMeshSetting::Kind::AsIs;
    return input;
}

/// A bent limb without any symmetry, with flat ends that the bending leaves flat: a caterpillar's bar, curved in its middle.
shapes::Body limb(int cells = 3) {
    shapes::Body body = shapes::bar(cells);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
        auto p = body.mesh.vertices.row(v);
        const double z = p.z(), bulge = z * (3.0 - z);
        p.x() += 0.11 * bulge * z;
        p.y() *= 1.0 + 0.2 * bulge;
        p.y() += 0.03 * bulge;
    }
    return body;
}

TriangleMesh moved(TriangleMesh mesh, const Eigen::Matrix3d& rotation, const Vec3& shift) {
    mesh.vertices = ((mesh.vertices * rotation.transpose()).rowwise() + shift.transpose()).eval();
    return mesh;
}

Eigen::Matrix3d rotation(double angle, const Vec3& axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("congruence: the response of a turned and shifted copy is that of its own precompute") {
    for (const BasisKind basis : {BasisKind::Affine, BasisKind::Paper, BasisKind::Full})
        for (const double angle : {0.0, 0.4, 1.9, 3.1}) {
            CAPTURE(int(basis));
            CAPTURE(angle);
            const shapes::Body body = limb();
            ResponseInput from = inputOf(body.mesh, body.ends, basis);
            ResponseInput to = inputOf(moved(body.mesh, rotation(angle, {0.3, -1.0, 0.7}), {4.0, -2.0, 9.0}), body.ends, basis);
            CHECK(findCongruence(from, to));
            from.loads = BodyLoads::Always;
            CHECK_FALSE(findCongruence(from, to));
            to.loads = BodyLoads::Always;
            const auto how = findCongruence(from, to);
            REQUIRE(how);
            CHECK(how->miss < 1e-14);
            CHECK(how->modeMiss < 1e-12);
            const auto first = buildResponse(from, {}), own = buildResponse(to, {});
            REQUIRE(first);
            REQUIRE(own);
            const auto carried = how->carry(*first);
            REQUIRE(carried);
            // The same triangles and no choice depends on the axes: what is left is rounding times the condition.
            CHECK(difference(carried->response, own->response) < 1e-9);
            CHECK(difference(carried->stiffness, own->stiffness) < 1e-9);
            CHECK(difference(carried->loads, own->loads) < 1e-9);
            CHECK(difference(carried->loadForces, own->loadForces) < 1e-9);
            if (basis == BasisKind::Full) CHECK(difference(carried->tractions, own->tractions) < 1e-9);
            CHECK(carried->stiffness == carried->stiffness.transpose());
            CHECK(carried->freeVertices == own->freeVertices);
            CHECK(carried->firstColumn == own->firstColumn);
            CHECK(carried->quality.solve.residual == first->quality.solve.residual);
            // Not the response itself: frames follow global axes.
            if (angle > 0.0) CHECK(difference(first->response, own->response) > 1e-3);
        }
}

TEST_CASE("congruence: the response of a mirror image is that of its own precompute, reflected, with loads and fingers") {
    for (const BasisKind basis : {BasisKind::Affine, BasisKind::Paper, BasisKind::Full}) {
        CAPTURE(int(basis));
        const shapes::Body body = limb();
        ResponseInput from = inputOf(body.mesh, body.ends, basis);
        TriangleMesh image = moved(body.mesh, rotation(0.7, {0.2, 1.0, -0.4}), {1.0, -2.0, 0.5});
        image.vertices.col(0) = (3.0 - image.vertices.col(0).array()).matrix().eval();
        ResponseInput inside = inputOf(image, body.ends, basis);  // not turned round: it faces inward
        image.triangles.col(1).swap(image.triangles.col(2));
        ResponseInput to = inputOf(image, body.ends, basis);
        for (ResponseInput* input : {&from, &inside, &to}) {
            input->loads = BodyLoads::Always;
            input->touch = 12;
        }
        CHECK_FALSE(findCongruence(from, inside));
        const auto how = findCongruence(from, to);
        REQUIRE(how);
        CHECK(how->mirrored);
        CHECK(how->rotation.determinant() == doctest::Approx(-1.0));
        CHECK(how->miss < 1e-14);
        CHECK(how->modeMiss < 1e-12);
        const auto first = buildResponse(from, {}), own = buildResponse(to, {});
        REQUIRE(first);
        REQUIRE(own);
        const auto carried = how->carry(*first);
        REQUIRE(carried);
        CHECK(carried->bases == own->bases);
        // Integrals over triangles whose corners come in another order differ by quadrature, which is far below the discretisation.
        CHECK(difference(carried->response, own->response) < 1e-5);
        CHECK(difference(carried->stiffness, own->stiffness) < 1e-5);
        CHECK(difference(carried->loads, own->loads) < 1e-5);
        CHECK(difference(carried->loadForces, own->loadForces) < 1e-5);
        if (basis == BasisKind::Full) CHECK(difference(carried->tractions, own->tractions) < 1e-5);
        CHECK(difference(carried->touch.compliance, own->touch.compliance) < 1e-4);
        // And back again it is the first one.
        const auto back = findCongruence(to, from);
        REQUIRE(back);
        const auto again = back->carry(*carried);
        REQUIRE(again);
        CHECK(difference(again->response, first->response) < 1e-11);
        CHECK(difference(again->stiffness, first->stiffness) < 1e-11);
    }
}

TEST_CASE("congruence: energy and displacement of the copy are those of the first for the motion turned back") {
    const shapes::Body body = limb();
    const ResponseInput from = inputOf(body.mesh, body.ends);
    const Eigen::Matrix3d R = rotation(2.2, {1.0, 0.2, -0.4});
    const ResponseInput to = inputOf(moved(body.mesh, R, {1.0, 2.0, 3.0}), body.ends);
    const auto first = buildResponse(from, {});
    REQUIRE(first);
    const auto how = findCongruence(from, to);
    REQUIRE(how);
    const auto carried = how->carry(*first);
    REQUIRE(carried);
    // Affine motions of both faces, in world axes of the first: x -> x + G x + s.
    Eigen::Matrix3d G;
    G << 0.1, -0.2, 0.05, 0.3, -0.1, 0.2, -0.15, 0.07, 0.2;
    const auto parameters = [](const ResponseInput& input, const ElementResponse& response, const Eigen::Matrix3d& gradient, const Vec3& shift, std::size_t face) {
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
        const FaceFrame& frame = input.faces[face].frame;
        JointMap map;
        map.linear += frame.axes.transpose() * gradient * frame.axes;
        map.shift = frame.axes.transpose() * (gradient * frame.origin + shift);
        double lost = 0.0;
        response.bases[face].coefficients(map, input.faces[face].size, v.data() + response.firstColumn[face], lost);
        return v;
    };
    const Vec3 shift(0.4, -0.1, 0.2);
    const Eigen::VectorXd v = parameters(from, *first, G, shift, 1);
    const Eigen::VectorXd w = parameters(to, *carried, R * G * R.transpose(), R * shift - R * G * R.transpose() * how->shift, 1);
    const double energy = v.dot(first->stiffness * v);
    CHECK(energy > 0.0);
    CHECK(w.dot(carried->stiffness * w) == doctest::Approx(energy).epsilon(1e-10));
    const Eigen::VectorXd u = first->response * v, turned = carried->response * w;
    double worst = 0.0;
    for (Eigen::Index i = 0; i < u.size(); i += 3) worst = std::max(worst, (R * u.segment<3>(i) - turned.segment<3>(i)).norm());
    CHECK(worst < 1e-11 * u.cwiseAbs().maxCoeff());
}

TEST_CASE("congruence: copies that files rounded to single precision are congruent, and carrying errs by as little") {
    const shapes::Body body = limb();
    TriangleMesh copy = moved(body.mesh, rotation(1.1, {0.0, 1.0, 1.0}), {0.2, 0.1, 0.5});
    copy.vertices = copy.vertices.cast<float>().cast<double>().eval();
    const ResponseInput from = inputOf(body.mesh, body.ends), to = inputOf(copy, body.ends);
    const auto how = findCongruence(from, to);
    REQUIRE(how);
    CHECK(how->miss > 1e-9);
    const auto first = buildResponse(from, {}), own = buildResponse(to, {});
    REQUIRE(first);
    REQUIRE(own);
    // Shape and joint modes each differ by about 1e-7.
    CHECK(difference(how->carry(*first)->response, own->response) < 1e-6);
    CHECK(difference(how->carry(*first)->stiffness, own->stiffness) < 1e-5);  // the gradient of A'
}

TEST_CASE("congruence: with the default solver mesh a copy differs from its own precompute by less than the estimated error") {
    const shapes::Body body = limb(2);
    ResponseInput from = inputOf(body.mesh, body.ends), to = inputOf(moved(body.mesh, rotation(0.7, {1.0, 1.0, 0.0}), {0.0, 7.0, 0.0}), body.ends);
    from.solverMesh = to.solverMesh = {};
    const auto how = findCongruence(from, to);
    REQUIRE(how);
    const auto first = buildResponse(from, {}), own = buildResponse(to, {});
    REQUIRE(first);
    REQUIRE(own);
    const auto carried = how->carry(*first);
    REQUIRE(carried);
    // Refinement breaks ties between edges of equal length by rounding, so that the two solver meshes may differ.
    REQUIRE(own->quality.error > 0.0);
    CHECK(difference(carried->response, own->response) < own->quality.error);
    CHECK(carried->quality.error == first->quality.error);
}

TEST_CASE("congruence: faces that are not flat keep their three more columns") {
    shapes::Body body = limb();
    for (const std::int32_t v : body.ends[1].vertices) {
        const double x = body.mesh.vertices(v, 0), y = body.mesh.vertices(v, 1);
        body.mesh.vertices(v, 2) += 0.2 * (x * x - 0.5 * x * y);
    }
    const ResponseInput from = inputOf(body.mesh, body.ends);
    const ResponseInput to = inputOf(moved(body.mesh, rotation(2.5, {1.0, 0.5, 0.2}), {1.0, 0.0, 0.0}), body.ends);
    REQUIRE(!from.faces[1].flat());
    const auto how = findCongruence(from, to);
    REQUIRE(how);
    const auto first = buildResponse(from, {}), own = buildResponse(to, {});
    REQUIRE(first);
    REQUIRE(own);
    CHECK(own->columns() == 21);
    CHECK(difference(how->carry(*first)->response, own->response) < 1e-9);
    CHECK(difference(how->carry(*first)->stiffness, own->stiffness) < 1e-9);
}

TEST_CASE("congruence: copies turned inside out, scaled, bent and others are not congruent") {
    const shapes::Body body = limb();
    const ResponseInput from = inputOf(body.mesh, body.ends);
    const Eigen::Matrix3d R = rotation(0.9, {1.0, 2.0, 3.0});
    const TriangleMesh copy = moved(body.mesh, R, {1.0, 0.0, 0.0});
    CHECK(findCongruence(from, inputOf(copy, body.ends)));

    TriangleMesh mirrored = copy;
    mirrored.vertices.col(0) = -mirrored.vertices.col(0);
    ResponseInput other = inputOf(copy, body.ends);
    auto inside = std::make_shared<ElementMesh>(*other.mesh);
    inside->body.vertices = mirrored.vertices;  // even with the same triangles
    other.mesh = inside;
    CHECK(!findCongruence(from, other));

    TriangleMesh scaled = copy;
    scaled.vertices *= 1.0 + 1e-5;
    CHECK(!findCongruence(from, inputOf(scaled, body.ends)));
    TriangleMesh dented = copy;
    dented.vertices(dented.vertices.rows() / 2, 1) += 1e-4;
    CHECK(!findCongruence(from, inputOf(dented, body.ends)));

    CHECK(!findCongruence(from, inputOf(copy, {body.ends[0]})));
    CHECK(!findCongruence(from, inputOf(copy, {body.ends[1], body.ends[0]})));
    CHECK(!findCongruence(from, inputOf(copy, body.ends, BasisKind::Paper)));
    other = inputOf(copy, body.ends);
    other.nu = 0.3;
    CHECK(!findCongruence(from, other));
    other = inputOf(copy, body.ends);
    other.solverMesh = {};
    CHECK(!findCongruence(from, other));
    CHECK(!findCongruence(inputOf(body.mesh, {}), inputOf(copy, {})));
    CHECK(!findCongruence({}, from));
}

TEST_CASE("congruence: size and place do not matter") {
    for (const double size : {1e-6, 1.0, 1e6}) {
        CAPTURE(size);
        shapes::Body body = limb(2);
        body.mesh.vertices *= size;
        const ResponseInput from = inputOf(body.mesh, body.ends);
        const ResponseInput to = inputOf(moved(body.mesh, rotation(1.3, {1.0, 0.2, 0.3}), 1e3 * size * Vec3(1.0, -2.0, 3.0)), body.ends);
        const auto how = findCongruence(from, to);
        REQUIRE(how);
        CHECK(how->miss < 1e-11);  // a thousand sizes away three digits are gone
        CHECK((how->rotation * how->rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-14);
        CHECK(how->rotation.determinant() > 0.0);
    }
}

TEST_CASE("congruence: a response of another element is refused") {
    const shapes::Body body = limb(2);
    const auto how = findCongruence(inputOf(body.mesh, body.ends), inputOf(body.mesh, body.ends));
    REQUIRE(how);
    CHECK(how->carry({}).error().code == "bad-value");
    const auto one = buildResponse(inputOf(body.mesh, {body.ends[0]}), {});
    REQUIRE(one);
    CHECK(how->carry(*one).error().code == "bad-value");
}
