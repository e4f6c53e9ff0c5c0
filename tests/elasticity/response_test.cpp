// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/element_response.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

ResponseInput reducedInput(const shapes::Body& body, BasisKind basis = BasisKind::Affine, double nu = 0.4) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const auto& end : body.ends) {
        auto face = jointFaceByVertices(body.mesh, end.vertices);
        REQUIRE(face);
        input.faces.push_back(*face);
    }
    input.basis = basis;
    input.nu = nu;
    return input;
}

/// Joint parameters of the affine map x -> x + gradient x + shift of the whole body.
Eigen::VectorXd parametersOf(const ResponseInput& input, const ElementResponse& response, const Eigen::Matrix3d& gradient, const Vec3& shift) {
    Eigen::VectorXd v(response.columns());
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const FaceFrame& frame = input.faces[f].frame;
        JointMap map;
        map.linear += frame.axes.transpose() * gradient * frame.axes;
        map.shift = frame.axes.transpose() * (gradient * frame.origin + shift);
        double lost = 0.0;
        response.bases[f].coefficients(map, input.faces[f].size, v.data() + response.firstColumn[f], lost);
    }
    return v;
}

/// Largest distance of A' v from the affine motion, relative to its largest displacement.
double missed(const ResponseInput& input, const ElementResponse& response, const Eigen::Matrix3d& gradient, const Vec3& shift) {
    const Eigen::VectorXd u = response.response * parametersOf(input, response, gradient, shift);
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
        const Vec3 expected = gradient * input.mesh->body.vertices.row(response.freeVertices[i]).transpose() + shift;
        worst = std::max(worst, (u.segment<3>(3 * static_cast<Eigen::Index>(i)) - expected).norm());
        largest = std::max(largest, expected.norm());
    }
    return worst / largest;
}

Eigen::Matrix3d spin(const Vec3& w) {
    Eigen::Matrix3d m;
    m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return m;
}

shapes::Body obliquePrism() {
    // Not along an axis and not at the origin.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    return shapes::moved(shapes::cylinder(0.5, 2.0, 18, 10), turn, Vec3(3, -1, 2));
}

}  // namespace

TEST_CASE("reduced element: a rigid motion of all joint faces gives the same rigid motion and costs no energy") {
    for (const auto& body : {obliquePrism(), shapes::bar(3)}) {
        const ResponseInput input = reducedInput(body);
        const auto response = buildResponse(input, {});
        REQUIRE(response);
        const double scale = response->stiffness.norm();
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(missed(input, *response, Eigen::Matrix3d::Zero(), Vec3::Unit(axis)) <= 1e-12);
            CHECK(missed(input, *response, spin(Vec3::Unit(axis)), Vec3::Zero()) <= 1e-12);
            const Eigen::VectorXd shift = parametersOf(input, *response, Eigen::Matrix3d::Zero(), Vec3::Unit(axis));
            const Eigen::VectorXd turn = parametersOf(input, *response, spin(Vec3::Unit(axis)), Vec3::Zero());
            CHECK((response->stiffness * shift).norm() <= 1e-12 * scale * shift.norm());
            CHECK((response->stiffness * turn).norm() <= 1e-12 * scale * turn.norm());
        }
    }
}

TEST_CASE("reduced element: stretching the ends of a bar has the energy of uniaxial tension") {
    for (const double nu : {0.0, 0.3, 0.49}) {
        const ResponseInput input = reducedInput(shapes::bar(3), BasisKind::Paper, nu);
        const auto response = buildResponse(input, {});
        REQUIRE(response);
        const Eigen::Matrix3d gradient = Vec3(-nu, -nu, 1.0).asDiagonal();
        CHECK(missed(input, *response, gradient, Vec3::Zero()) <= 1e-11);
        const Eigen::VectorXd v = parametersOf(input, *response, gradient, Vec3::Zero());
        // 1/2 E volume, E = 2 (1 + nu), volume 3.
        CHECK(0.5 * v.dot(response->stiffness * v) == doctest::Approx(3.0 * (1.0 + nu)).epsilon(1e-9));
    }
}

TEST_CASE("reduced element: the stiffness is symmetric and without negative energy, and says how far it was from it") {
    for (const BasisKind basis : {BasisKind::Paper, BasisKind::Affine}) {
        ResponseInput input = reducedInput(obliquePrism(), basis);
        input.solverMesh = parseSolverMesh("as-is").value();  // by boundary elements, which are as far from it as collocation leaves them
        const auto response = buildResponse(input, {});
        REQUIRE(response);
        const Eigen::MatrixXd& K = response->stiffness;
        REQUIRE(K.rows() == response->columns());
        CHECK(K == K.transpose());
        CHECK(response->quality.asymmetry > 0.0);
        CHECK(response->quality.asymmetry <= 0.03);  // about 1 % on compact bodies
        CHECK(response->quality.negativeEnergy <= 0.0);
        CHECK(response->quality.negativeEnergy >= -1e-3);
        // No direction has less than rounding.
        std::srand(1);
        for (int i = 0; i < 200; ++i) {
            const Eigen::VectorXd v = Eigen::VectorXd::Random(K.rows());
            CHECK(v.dot(K * v) >= -1e-12 * K.norm() * v.squaredNorm());
        }
        CHECK(response->quality.solve.residual <= 1e-10);
        CHECK(response->quality.solve.rcond > 1e-4);
        CHECK(response->bytes() > 0);
    }
}

TEST_CASE("reduced element: its answer is that of the full solution for the same face displacements") {
    const ResponseInput input = reducedInput(obliquePrism());
    const auto response = buildResponse(input, {});
    REQUIRE(response);
    const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(response->columns(), -0.2, 0.3);
    std::vector<Points> faces;
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const JointFace& face = input.faces[f];
        Points moved(static_cast<Eigen::Index>(face.vertices.size()), 3);
        for (std::size_t i = 0; i < face.vertices.size(); ++i) {
            const Vec3 local = face.frame.toLocal(input.mesh->body.vertices.row(face.vertices[i]).transpose());
            moved.row(static_cast<Eigen::Index>(i)) =
                (face.frame.axes * (response->bases[f].at(local) * v.segment(response->firstColumn[f], response->bases[f].columns())))
                    .transpose();
        }
        faces.push_back(moved);
    }
    const auto full = solveFull(input, faces, {});
    REQUIRE(full);
    const Eigen::VectorXd u = response->response * v;
    for (std::size_t i = 0; i < response->freeVertices.size(); ++i)
        CHECK((full->row(response->freeVertices[i]).transpose() - u.segment<3>(3 * static_cast<Eigen::Index>(i))).norm() <= 1e-12);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i)
            CHECK(full->row(input.faces[f].vertices[i]) == faces[f].row(static_cast<Eigen::Index>(i)));
    faces.pop_back();
    CHECK(solveFull(input, faces, {}).error().code == "bad-value");
}

TEST_CASE("reduced element: one without joint faces has no columns, one with a single face follows it") {
    shapes::Body body = shapes::bar(2);
    body.ends.pop_back();
    const ResponseInput single = reducedInput(body);
    const auto one = buildResponse(single, {});
    REQUIRE(one);
    CHECK(one->columns() == 9);
    CHECK(missed(single, *one, spin(Vec3(0.3, -0.2, 0.5)), Vec3(1, 2, 3)) <= 1e-12);
    body.ends.clear();
    const auto none = buildResponse(reducedInput(body), {});
    REQUIRE(none);
    CHECK(none->columns() == 0);
    CHECK(none->freeVertices.size() == static_cast<std::size_t>(body.mesh.vertices.rows()));
    CHECK(none->response.rows() == 3 * body.mesh.vertices.rows());
    CHECK(none->response.cols() == 0);
}

TEST_CASE("reduced element: the bytes do not depend on the number of threads, and the key not either") {
    ResponseInput input = reducedInput(obliquePrism());
    const auto one = buildResponse(input, {});
    const ContentKey key = responseKey(input);
    input.threads = 2;
    const auto two = buildResponse(input, {});
    CHECK(one->response == two->response);
    CHECK(one->stiffness == two->stiffness);
    CHECK(responseKey(input) == key);
}

TEST_CASE("reduced element: the key notices everything that matters") {
    const ResponseInput input = reducedInput(obliquePrism());
    const ContentKey key = responseKey(input);
    ResponseInput other = input;
    other.nu = 0.41;
    CHECK(responseKey(other) != key);
    other = input;
    other.basis = BasisKind::Paper;
    CHECK(responseKey(other) != key);
    other = input;
    other.faces.pop_back();
    CHECK(responseKey(other) != key);
    other = input;
    other.faces[1].frame.axes.col(0) *= -1.0;
    CHECK(responseKey(other) != key);
    other = input;
    auto mesh = std::make_shared<ElementMesh>(*input.mesh);
    mesh->body.vertices(7, 1) += 1e-9;
    other.mesh = mesh;
    CHECK(responseKey(other) != key);
    other = input;
    other.faces[0].name = "renamed";
    CHECK(responseKey(other) == key);
}

TEST_CASE("reduced element: what cannot be precomputed is refused, and cancelling is an answer") {
    ResponseInput input = reducedInput(shapes::bar(2));
    std::stop_source stop;
    stop.request_stop();
    CHECK(buildResponse(input, Progress({}, stop.get_token())).error().code == kCancelled);
    input.faces[0].vertices[0] = -1;
    CHECK(buildResponse(input, {}).error().code == "bad-value");
    input.mesh = nullptr;
    CHECK(buildResponse(input, {}).error().code == "bad-value");
}

TEST_CASE("reduced element: the estimate is positive and grows with the mesh") {
    // The large one first: what is known of the machine only becomes better.
    const auto large = estimateResponse(reducedInput(shapes::bar(8))), small = estimateResponse(reducedInput(shapes::bar(3)));
    CHECK(small.columns == 18);
    CHECK(small.seconds > 0.0);
    CHECK(large.seconds > small.seconds);
    CHECK(large.bytes > small.bytes);
    CHECK(small.frameMilliseconds > 0.0);
}
