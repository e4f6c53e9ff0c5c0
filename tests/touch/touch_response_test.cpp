// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/elasticity/boundary_problem.h"
#include "core/mesh/topology.h"
#include "core/reduction/congruence.h"
#include "tests/support/voxels.h"
#include "tests/touch/bodies.h"

using namespace imomushi;
using namespace imomushi::touching;

namespace {

/// Joint parameters of all faces for a displacement of their vertices.
template <class Field>
Eigen::VectorXd parametersOf(const Touched& body, const Field& field) {
    const ElementResponse& r = *body.response;
    Eigen::VectorXd v(r.columns());
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const FaceFrame& frame = body.faces[f].frame;
        const auto count = static_cast<Eigen::Index>(body.faces[f].vertices.size());
        Eigen::MatrixXd C(3 * count, r.bases[f].columns());
        Eigen::VectorXd u(3 * count);
        for (Eigen::Index i = 0; i < count; ++i) {
            const Vec3 p = body.mesh.vertices.row(body.faces[f].vertices[static_cast<std::size_t>(i)]).transpose();
            C.middleRows(3 * i, 3) = frame.axes * r.bases[f].at(frame.toLocal(p), static_cast<int>(i));
            u.segment<3>(3 * i) = field(p);
        }
        v.segment(r.firstColumn[f], C.cols()) = C.completeOrthogonalDecomposition().solve(u);
    }
    return v;
}

/// 3 P x 3 #V: the mean displacement of each patch, its bump for a weight.
Eigen::MatrixXd patchMeans(const Touched& body) {
    const TouchPatches& patches = body.response->touch.patches;
    const Eigen::MatrixXd weights = patches.dense();
    std::vector<std::int32_t> held;
    for (const JointFace& face : body.faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
    const auto touchable = touchableTriangles(body.mesh, EdgeTable(body.mesh.triangles), held);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(patches.count(), body.mesh.vertices.rows());
    for (std::int32_t f = 0; f < body.mesh.triangles.rows(); ++f) {
        if (!touchable[static_cast<std::size_t>(f)]) continue;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                mass.col(body.mesh.triangles(f, a)) +=
                    areaVector(body.mesh, f).norm() / 24.0 * (a == b ? 2.0 : 1.0) * weights.row(body.mesh.triangles(f, b)).transpose();
    }
    mass.array().colwise() /= mass.rowwise().sum().array();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * mass.rows(), 3 * mass.cols());
    for (Eigen::Index p = 0; p < mass.rows(); ++p)
        for (Eigen::Index v = 0; v < mass.cols(); ++v)
            for (int axis = 0; axis < 3; ++axis) out(3 * p + axis, 3 * v + axis) = mass(p, v);
    return out;
}

}  // namespace

TEST_CASE("touch patches: bumps cover what is free and visible, and add up to 1") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        const TouchPatches& patches = body->response->touch.patches;
        std::vector<char> wanted(static_cast<std::size_t>(body->mesh.vertices.rows()));
        std::vector<std::int32_t> held;
        for (const JointFace& face : body->faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
        const auto touchable = touchableTriangles(body->mesh, EdgeTable(body->mesh.triangles), held);
        for (std::int32_t f = 0; f < body->mesh.triangles.rows(); ++f)
            for (int c = 0; c < 3 && touchable[static_cast<std::size_t>(f)]; ++c) wanted[static_cast<std::size_t>(body->mesh.triangles(f, c))] = 1;
        const Eigen::MatrixXd weights = patches.dense();
        for (Eigen::Index v = 0; v < weights.rows(); ++v)
            CHECK(weights.row(v).sum() == doctest::Approx(wanted[static_cast<std::size_t>(v)] ? 1.0 : 0.0).epsilon(1e-6));
        CHECK(weights.minCoeff() >= 0.0);
        for (int p = 0; p < patches.count(); ++p)
            CHECK(weights(patches.centre[static_cast<std::size_t>(p)], p) >= 0.3);  // the largest there, among four or five
    }
    // The cavity of the shell: vertices after those of the outer sphere.
    const TouchPatches& patches = shell().response->touch.patches;
    CHECK(patches.first[642] == patches.first.back());
    CHECK(patches.count() == 32);
}

TEST_CASE("touch patches: a bump on one side of a thin fin does not reach through it") {
    const TouchPatches& patches = fin().response->touch.patches;
    const Eigen::MatrixXd weights = patches.dense();
    int through = 0, sameSide = 0;
    for (int p = 0; p < patches.count(); ++p) {
        const Vec3 c = fin().mesh.vertices.row(patches.centre[static_cast<std::size_t>(p)]).transpose();
        for (Eigen::Index v = 0; v < weights.rows(); ++v) {
            const Vec3 x = fin().mesh.vertices.row(v).transpose();
            if (x.y() * c.y() > 0.0) sameSide += weights(v, p) > 0.0;
            if (x.y() * c.y() > 0.0 || (x - c).norm() >= patches.reach) continue;
            // Straight through it is near; around a rim, no way is shorter than this.
            const double around = 0.08 + std::min({1.0 - x.x() - c.x(), 1.0 + x.x() + c.x(), 3.0 - x.z() - c.z()});
            if (around < patches.reach) continue;
            ++through;
            CHECK(weights(v, p) == 0.0);
        }
    }
    CHECK(through > 100);
    CHECK(sameSide > 500);
}

TEST_CASE("touch patches: there are no more than vertices carry, one at least on each part, none without joint faces") {
    const auto coarse = shapes::cylinder(0.5, 1.0, 6, 2);
    const auto input = inputOf(coarse.mesh, coarse.ends, 96);
    CHECK(touchPatches({coarse.mesh, {}}, input.faces, 96).count() == 4);  // three rings of six vertices
    CHECK(touchPatches({coarse.mesh, {}}, {}, 96).count() == 0);
    CHECK(touchPatches({coarse.mesh, {}}, input.faces, 1).count() == 1);
    // A ring of a face cuts the surface of a bar in two.
    const auto bar = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 4), 2, 2, 8);
    const auto ring = shapes::patchWhere(
        bar.mesh, [](const Vec3& p) { return p.z() >= 1.5 && p.z() <= 2.5 && (p.x() == 0.0 || p.x() == 1.0 || p.y() == 0.0 || p.y() == 1.0); });
    JointFace face;
    face.vertices = ring.vertices;
    face.triangles = ring.triangles;
    CHECK(touchPatches({bar.mesh, {}}, std::vector{face}, 1).count() == 2);
}

TEST_CASE("touch response: the compliance is symmetric, positive, and was so before it was cleaned") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        const TouchResponse& t = body->response->touch;
        CHECK((t.compliance == t.compliance.transpose()));
        CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(t.compliance, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >=
              -1e-12 * t.compliance.norm());
        MESSAGE(name << ": " << t.patches.count() << " patches of reach " << t.patches.reach << ", asymmetry " << t.asymmetry << ", negative "
                     << t.negativeEnergy);
        // Collocation on the plain mesh: as for stiffnesses, about 1 % on compact bodies and 6 to 36 % on thin plates.
        CHECK(t.asymmetry <= (name == "fin" ? 0.36 : 0.02));
        CHECK(t.negativeEnergy >= -0.01);
    }
}

TEST_CASE("touch response: the mean displacement of patch i by a force on patch j is that of j by i") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        const TouchResponse& t = body->response->touch;
        Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3 * body->mesh.vertices.rows(), t.columns());
        for (std::size_t i = 0; i < body->response->freeVertices.size(); ++i)
            u.middleRows<3>(3 * body->response->freeVertices[i]) = t.displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
        const Eigen::MatrixXd mean = patchMeans(*body) * u;
        CHECK((mean - t.compliance).norm() <= (name == "fin" ? 0.2 : 0.02) * mean.norm());
    }
}

TEST_CASE("touch response: what a patch does to joint parameters is what joint parameters do to the patch (Betti)") {
    for (const auto& [name, body] : all()) {
        CAPTURE(name);
        const ElementResponse& r = *body->response;
        Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3 * body->mesh.vertices.rows(), r.columns());
        for (std::size_t i = 0; i < r.freeVertices.size(); ++i)
            u.middleRows<3>(3 * r.freeVertices[i]) = r.response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
        for (std::size_t f = 0; f < body->faces.size(); ++f)
            for (std::size_t i = 0; i < body->faces[f].vertices.size(); ++i) {
                const std::int32_t v = body->faces[f].vertices[i];
                const FaceFrame& frame = body->faces[f].frame;
                u.block(3 * v, r.firstColumn[f], 3, r.bases[f].columns()) =
                    frame.axes * r.bases[f].at(frame.toLocal(body->mesh.vertices.row(v).transpose()), static_cast<int>(i));
            }
        const Eigen::MatrixXd forces = -(patchMeans(*body) * u).transpose();
        const double missed = (forces - r.touch.forces).norm() / forces.norm();
        MESSAGE(name << ": " << missed);
        CHECK(missed <= 0.05);
    }
}

TEST_CASE("touch response: the joint faces carry the force and the moment of a finger exactly") {
    const Touched& body = segment();
    const TouchResponse& t = body.response->touch;
    const Eigen::MatrixXd means = patchMeans(body);
    for (int k = 0; k < 6; ++k) {
        const auto rigid = [&](const Vec3& p) -> Vec3 { return k < 3 ? Vec3(Vec3::Unit(k)) : Vec3(Vec3::Unit(k - 3).cross(p)); };
        const Eigen::VectorXd v = parametersOf(body, rigid);
        Eigen::VectorXd u(3 * body.mesh.vertices.rows());
        for (Eigen::Index i = 0; i < body.mesh.vertices.rows(); ++i) u.segment<3>(3 * i) = rigid(body.mesh.vertices.row(i).transpose());
        CHECK((t.forces.transpose() * v + means * u).norm() <= 1e-6);  // weights are in single precision
    }
}

TEST_CASE("touch response: the dent of a Gaussian pressure on a large flat face is that of an elastic half space") {
    // Boussinesq: u_z(x) = (1 - nu) / (2 pi mu) int p / r dS (Johnson 1985, section 3.2), here of the same pressure, linear on the triangles, in
    // closed form. A cylinder of nearly ten times its width: how it gives way as a whole is left out by looking at differences from a point beside
    // the dent.
    constexpr double kRadius = 1.0, kWidth = 0.12, kNu = 0.3;
    auto body = shapes::cylinder(kRadius, 1.0, 60, 6);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v) {
        auto p = body.mesh.vertices.row(v);
        if (p.z() != 1.0) continue;
        const double r = std::hypot(p.x(), p.y());
        p.leftCols<2>() *= r;  // rings closer together in the middle: 0.01 0.04 0.09 0.16 0.25
    }
    BoundaryProblem::Input input;
    input.mesh = &body.mesh;
    input.held = {{body.ends[0].vertices, body.ends[0].triangles}};
    input.nu = kNu;
    auto problem = BoundaryProblem::build(input, {});
    REQUIRE(problem);
    Eigen::MatrixXd pressure = Eigen::MatrixXd::Zero(body.mesh.vertices.rows(), 1);
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); ++v)
        if (body.mesh.vertices(v, 2) == 1.0) pressure(v, 0) = std::exp(-body.mesh.vertices.row(v).leftCols<2>().squaredNorm() / (kWidth * kWidth));
    BoundaryProblem::Loads loads;
    loads.tractions = &pressure;
    const auto solution = problem->solve(Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(body.ends[0].vertices.size()), 0), loads, {});
    REQUIRE(solution);
    const auto boussinesq = [&](const Vec3& x) {
        double sum = 0.0;
        for (std::int32_t f = 0; f < body.mesh.triangles.rows(); ++f) {
            std::array<Vec3, 3> corners;
            bool top = true;
            for (int c = 0; c < 3; ++c) {
                corners[static_cast<std::size_t>(c)] = body.mesh.vertices.row(body.mesh.triangles(f, c)).transpose();
                top = top && corners[static_cast<std::size_t>(c)].z() == 1.0;
            }
            if (!top) continue;
            const Vec3 integrals = triangleIntegrals(x, corners).singleLayerLinear;
            for (int c = 0; c < 3; ++c) sum += integrals[c] * pressure(body.mesh.triangles(f, c), 0);
        }
        return (1.0 - kNu) / (2.0 * std::numbers::pi) * sum;
    };
    struct Seen {
        double radius, found, expected;
    };
    std::vector<Seen> seen;
    for (std::size_t i = 0; i < problem->freeVertices().size(); ++i) {
        const Vec3 p = body.mesh.vertices.row(problem->freeVertices()[i]).transpose();
        if (p.z() == 1.0 && std::hypot(p.x(), p.y()) < 0.3)
            seen.push_back({std::hypot(p.x(), p.y()), solution->displacement(3 * static_cast<Eigen::Index>(i) + 2, 2), boussinesq(p)});
    }
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.radius < b.radius; });
    REQUIRE(seen.size() > 200);
    // The closed form of the Gaussian itself, at its middle: (1 - nu) F / (2 sqrt(pi) mu a).
    CHECK(seen.front().expected == doctest::Approx((1.0 - kNu) * std::sqrt(std::numbers::pi) * kWidth / 2.0).epsilon(0.03));
    double worst = 0.0;
    for (const Seen& s : seen) worst = std::max(worst, std::abs((s.found - seen.back().found) - (s.expected - seen.back().expected)));
    MESSAGE("worst " << worst / seen.front().expected << " of the dent");
    // Linear displacement on rings of a third of the width misses its curvature by h^2 / (8 a^2), 2 %; the finite body bends the rest by (r / R)^2 a
    // / R, 1 %.
    CHECK(worst <= 0.04 * seen.front().expected);
}

TEST_CASE("touch response: it turns with the body, and a congruent element gets the same by carrying") {
    const auto shape = shapes::cylinder(0.5, 1.0, 15, 5);
    const ResponseInput from = inputOf(shape.mesh, shape.ends, 12);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    const auto turned = shapes::moved(shape, R, Vec3(3, -1, 2));
    const ResponseInput to = inputOf(turned.mesh, shape.ends, 12);
    const Touched a = precompute(from), b = precompute(to);
    const TouchResponse &x = a.response->touch, &y = b.response->touch;
    CHECK(x.patches.centre == y.patches.centre);
    const auto congruence = findCongruence(from, to);
    REQUIRE(congruence);
    const auto carried = congruence->carry(*a.response);
    REQUIRE(carried);
    CHECK((carried->touch.displacement - y.displacement).norm() <= 1e-5 * y.displacement.norm());
    CHECK((carried->touch.forces - y.forces).norm() <= 1e-5 * y.forces.norm());
    CHECK((carried->touch.compliance - y.compliance).norm() <= 1e-5 * y.compliance.norm());
    REQUIRE(carried->touch.probes == y.probes);
    CHECK((carried->touch.gradients - y.gradients).norm() <= 1e-4 * y.gradients.norm());
    const Eigen::Matrix3f Rf = R.cast<float>();
    const Eigen::Matrix3f block = Rf * x.displacement.block<3, 3>(30, 9) * Rf.transpose();
    CHECK((block - y.displacement.block<3, 3>(30, 9)).norm() <= 1e-5f * y.displacement.norm());
    ResponseInput without = to;
    without.touch = 0;
    CHECK_FALSE(findCongruence(from, without));
}

TEST_CASE("touch response: without touch nothing changes, with it the key does, and threads change no byte") {
    const auto shape = shapes::cylinder(0.5, 1.0, 15, 5);
    ResponseInput input = inputOf(shape.mesh, shape.ends, 12);
    const ElementResponse with = buildResponse(input, {}).value();
    input.threads = 2;
    const ElementResponse again = buildResponse(input, {}).value();
    CHECK((with.touch.displacement == again.touch.displacement));
    CHECK((with.touch.compliance == again.touch.compliance));
    CHECK((with.touch.gradients == again.touch.gradients));
    CHECK(with.touch.probes == again.touch.probes);
    const ContentKey key = responseKey(input);
    input.touch = 13;
    CHECK(responseKey(input) != key);
    input.touch = 0;
    CHECK(responseKey(input) != key);
    const ElementResponse without = buildResponse(input, {}).value();
    CHECK(without.touch.bytes() == 0);
    CHECK((without.response - with.response).norm() <= 1e-9 * with.response.norm());
    CHECK((without.stiffness - with.stiffness).norm() <= 1e-12 * with.stiffness.norm());
    CHECK(estimateResponse(input).seconds > 0.0);
    input.touch = -1;
    CHECK(buildResponse(input, {}).error().code == "bad-value");
    input.touch = ResponseInput::kMaxTouch + 1;
    CHECK(buildResponse(input, {}).error().code == "bad-value");
}

TEST_CASE("touch response: other solver meshes give nearly the same dents") {
    const auto shape = shapes::cylinder(0.5, 1.2, 24, 12);
    const Touched plain = precompute(inputOf(shape.mesh, shape.ends, 12));
    const Touched decimated = precompute(inputOf(shape.mesh, shape.ends, 12, 0.45, {SolverMeshSetting::Kind::Decimated, 250}));
    REQUIRE(decimated.response->quality.decimated);
    const TouchResponse &a = plain.response->touch, &b = decimated.response->touch;
    REQUIRE(a.patches.centre == b.patches.centre);
    const double difference = (a.displacement - b.displacement).norm() / a.displacement.norm();
    MESSAGE("decimated: " << difference);
    // The plain mesh is wrong by a few percent (solved_body.h), the decimated body by a few percent of its thickness.
    CHECK(difference <= 0.1);
}

TEST_CASE("touch response: a finger at the tip of a horn bends it like a cantilever, and moves the body it stands on") {
    using shapes::block;
    using shapes::operator+;
    // A bar of 1 x 1 x 2 m held at both ends; a horn of 0.25 x 0.25 x 1.25 m on its side y = 1, which is cut off for the joint modes.
    constexpr double kSide = 0.25, kLength = 1.25, kNu = 0.3;
    const TriangleMesh mesh = shapes::surfaceOf(block({0, 0, 0}, {4, 4, 8}) + block({1, 4, 3}, {2, 9, 4}), kSide);
    const std::vector<shapes::Patch> ends{shapes::patchWhere(mesh, [](const Vec3& p) { return p.z() < 1e-9; }),
                                          shapes::patchWhere(mesh, [](const Vec3& p) { return p.z() > 2.0 - 1e-9; })};
    const Touched body = precompute(inputOf(mesh, ends, 24, kNu, {SolverMeshSetting::Kind::Refined, 800}));
    const TouchPatches& patches = body.response->touch.patches;
    int tip = 0;
    for (int p = 0; p < patches.count(); ++p)
        if (mesh.vertices(patches.centre[static_cast<std::size_t>(p)], 1) > mesh.vertices(patches.centre[static_cast<std::size_t>(tip)], 1)) tip = p;
    // By the same force per length, as slender beams bend: y^2 (3 x - y) / (6 E I) at x beyond y.
    const Eigen::MatrixXd weights = patches.dense();
    const double EI = 2.0 * (1.0 + kNu) * std::pow(kSide, 4) / 12.0;
    double expected = 0.0, sum = 0.0;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const double share = areaVector(mesh, f).norm() * weights(mesh.triangles(f, c), tip),
                         y = std::max(0.0, mesh.vertices(mesh.triangles(f, c), 1) - 1.0);
            expected += share * y * y * (3.0 * kLength - y) / (6.0 * EI);
            sum += share;
        }
    expected /= sum;
    double found = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < body.response->freeVertices.size(); ++i)
        if (mesh.vertices(body.response->freeVertices[i], 1) > 1.0 + kLength - 1e-9) {
            found += static_cast<double>(body.response->touch.displacement(3 * static_cast<Eigen::Index>(i) + 2, 3 * tip + 2));
            ++count;
        }
    found /= count;
    MESSAGE("tip " << found << ", a beam " << expected);
    // Shear and the foot, which gives way, add to the beam; four elements along it take some away.
    CHECK(found >= 0.9 * expected);
    CHECK(found <= 1.5 * expected);
}
