// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <stop_token>

#include "core/mesh/topology.h"
#include "core/meshing/decimation.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/display_mapping.h"
#include "core/reduction/element_response.h"
#include "core/reduction/element_statics.h"
#include "core/reduction/held_modes.h"
#include "tests/reduction/faces.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

using Field = std::function<Vec3(const Vec3&)>;

std::vector<char> held(const shapes::Body& body) {
    std::vector<char> out(static_cast<std::size_t>(body.mesh.vertices.rows()), 0);
    for (const auto& end : body.ends)
        for (const auto v : end.vertices) out[static_cast<std::size_t>(v)] = 1;
    return out;
}

std::vector<std::int32_t> heldTriangles(const std::vector<JointFace>& faces) {
    std::vector<std::int32_t> out;
    for (const auto& face : faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

Eigen::MatrixXd sample(const Points& points, const Field& field) {
    Eigen::MatrixXd u(3 * points.rows(), 1);
    for (Eigen::Index v = 0; v < points.rows(); ++v) u.block<3, 1>(3 * v, 0) = field(points.row(v).transpose());
    return u;
}

/// Moves the vertices that are not left out along their normals by a wave of the given height and length.
Points wrinkled(const TriangleMesh& mesh, const std::vector<char>& leaveOut, double height, double length) {
    const Points normals = vertexNormals(mesh);
    Points out = mesh.vertices;
    for (Eigen::Index v = 0; v < out.rows(); ++v)
        if (!leaveOut[static_cast<std::size_t>(v)])
            out.row(v) += height * std::sin(2.0 * std::numbers::pi * (out(v, 2) + 0.3 * out(v, 0)) / length) * normals.row(v);
    return out;
}

double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEST_CASE("display mapping: a rigid motion of the solver mesh is the same rigid motion of the display, wrinkles included") {
    shapes::Body body = shapes::cylinder(0.5, 2.0, 48, 40);
    const auto out = held(body);
    const auto small = decimate(body.mesh, facesOf(body), 400, {}).value();
    body.mesh.vertices = wrinkled(body.mesh, out, 0.03, 0.2);
    const auto hold = heldTriangles(small.faces);
    const auto map = DisplayMapping::build({&body.mesh, out, &small.mesh, hold, 1}, {}).value();
    const Vec3 shift(0.3, -2.0, 1.0), spin(0.5, 1.0, -0.7);
    const Field rigid = [&](const Vec3& p) -> Vec3 { return shift + spin.cross(p); };
    for (const double nu : {0.0, 0.3, 0.5}) {
        const auto mapped = map.apply(sample(small.mesh.vertices, rigid), nu, 1, {}).value();
        for (std::size_t i = 0; i < map.vertices().size(); ++i)
            CHECK((mapped.displacement.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) - rigid(body.mesh.vertices.row(map.vertices()[i]).transpose())).norm() <= 1e-12);
    }
    CHECK(map.distance().largest <= 1.5 * 0.03 / std::sqrt(5.0));  // the wrinkles, and what decimation cut off
    CHECK(map.distance().largest >= map.distance().rms);
    CHECK(map.distance().rms >= 0.3 * 0.03 / std::sqrt(5.0));
}

TEST_CASE("display mapping: stretching a bar with free sides is exact, on wrinkles above and below them too") {
    shapes::Body body = shapes::bar(12);
    const auto out = held(body);
    const shapes::Body coarse = shapes::bar(4);
    const auto hold = heldTriangles(facesOf(coarse));
    body.mesh.vertices = wrinkled(body.mesh, out, 0.02, 0.4);
    const auto map = DisplayMapping::build({&body.mesh, out, &coarse.mesh, hold, 1}, {}).value();
    for (const double nu : {0.0, 0.3, 0.45, 0.5}) {
        const Field stretch = [nu](const Vec3& p) { return Vec3(-nu * p.x(), -nu * p.y(), p.z()); };
        const auto mapped = map.apply(sample(coarse.mesh.vertices, stretch), nu, 1, {}).value();
        for (std::size_t i = 0; i < map.vertices().size(); ++i)
            CHECK((mapped.displacement.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) - stretch(body.mesh.vertices.row(map.vertices()[i]).transpose())).norm() <= 1e-12);
        CHECK(mapped.error[0] <= 1e-12);
    }
}

TEST_CASE("display mapping: bending of a bar with free sides converges with order two, and the estimate is not below the error") {
    const double nu = 0.3;
    const Field bend = [nu](const Vec3& p) {
        return Vec3(0.5 * (p.z() * p.z() + nu * (p.x() * p.x() - p.y() * p.y())), nu * p.x() * p.y(), -p.x() * p.z());
    };
    const shapes::Body display = shapes::bar(24);
    const auto out = held(display);
    double last = 0.0;
    for (const int n : {3, 6, 12}) {
        const shapes::Body coarse = shapes::bar(n);
        const auto hold = heldTriangles(facesOf(coarse));
        const auto map = DisplayMapping::build({&display.mesh, out, &coarse.mesh, hold, 1}, {}).value();
        CHECK(map.distance().largest <= 1e-15);
        const auto mapped = map.apply(sample(coarse.mesh.vertices, bend), nu, 1, {}).value();
        Eigen::MatrixXd exact(mapped.displacement.rows(), 1);
        for (std::size_t i = 0; i < map.vertices().size(); ++i) exact.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) = bend(display.mesh.vertices.row(map.vertices()[i]).transpose());
        const double error = relative(mapped.displacement, exact);
        MESSAGE("cells per side ", n, ": error ", error, ", estimate ", mapped.error[0]);
        CHECK(error <= mapped.error[0]);
        if (last > 0.0) CHECK(std::log2(last / error) >= 0.9 * 2.0);
        last = error;
    }
}

namespace {

/// Displacements of all vertices of a body whose lower end is held and whose upper end is moved in several ways: 3 * #V x #upper. One factorisation serves them all.
Eigen::MatrixXd solved(const TriangleMesh& mesh, const std::vector<JointFace>& faces, double nu, const std::vector<Field>& upper) {
    ResponseInput input;
    input.mesh = std::make_shared<ElementMesh>(ElementMesh{mesh, {}});
    input.faces = faces;
    input.nu = nu;
    input.threads = 2;
    const TrimmedElement element = trimmedElement(input, {}).value();
    const SolvedBody body = solvedBody(element.input.mesh->body, element.input.faces, input.solverMesh, {}).value();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(mesh.vertices.size(), static_cast<Eigen::Index>(upper.size())), held;
    for (Eigen::Index k = 0; k < out.cols(); ++k) {
        Points prescribed = Points::Zero(mesh.vertices.rows(), 3);
        for (const std::int32_t v : faces[1].vertices) prescribed.row(v) = upper[static_cast<std::size_t>(k)](mesh.vertices.row(v).transpose()).transpose();
        out.col(k) = Eigen::Map<const Eigen::VectorXd>(prescribed.data(), prescribed.size());
        const Eigen::MatrixXd column = heldDisplacement(body, prescribed);
        held.conservativeResize(column.rows(), k + 1);
        held.col(k) = column;
    }
    const Eigen::MatrixXd response = solveStatics(element, body, held, {}, {}, {}).value().response;
    for (std::size_t i = 0; i < element.wholeFree.size(); ++i) out.middleRows<3>(3 * element.wholeFree[i]) = response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    return out;
}

struct Comparison {
    double error, estimate, shape;
};

/// A body solved as it is, and solved on the few vertices of `small` and mapped: for each of the motions of its upper end.
std::vector<Comparison> bothWays(const shapes::Body& body, const DecimatedBody& small, const Eigen::MatrixXd& coarse, double nu, const std::vector<Field>& upper) {
    const auto map = DisplayMapping::build({&body.mesh, held(body), &small.mesh, heldTriangles(small.faces), 2}, {}).value();
    const Eigen::MatrixXd fine = solved(body.mesh, facesOf(body), nu, upper);
    const auto mapped = map.apply(coarse, nu, 2, {}).value();
    std::vector<Comparison> out;
    for (Eigen::Index k = 0; k < fine.cols(); ++k) {
        Eigen::VectorXd expected(mapped.displacement.rows());
        for (std::size_t i = 0; i < map.vertices().size(); ++i) expected.segment<3>(3 * static_cast<Eigen::Index>(i)) = fine.col(k).segment<3>(3 * map.vertices()[i]);
        out.push_back({relative(mapped.displacement.col(k), expected), mapped.error[k], map.distance().shape});
    }
    return out;
}

const Field kPull = [](const Vec3&) { return Vec3(0, 0, 0.2); };
const Field kBend = [](const Vec3& p) { return Vec3(0, 0, 0.3 * p.x()); };
const Field kTwist = [](const Vec3& p) { return Vec3(-0.3 * p.y(), 0.3 * p.x(), 0); };

}  // namespace

TEST_CASE("display mapping: against solving on the display itself, the estimate is the error up to a factor of four") {
    // Linear triangles err in their corners by as many powers of their size as between them, which is what the estimate sees: the two differ
    // by a factor that depends on the pose and the rim. Solved both ways on 706 vertices.
    const shapes::Body body = shapes::cylinder(0.5, 2.0, 32, 13);
    const DecimatedBody small = decimate(body.mesh, facesOf(body), 250, {}).value();
    for (const double nu : {0.3, 0.45}) {
        const std::vector<Field> poses = {kPull, kBend, kTwist};
        for (const Comparison& c : bothWays(body, small, solved(small.mesh, small.faces, nu, poses), nu, poses)) {
            MESSAGE("nu ", nu, ": error ", c.error, ", estimate ", c.estimate);
            CHECK(c.error <= 4.0 * c.estimate);
            CHECK(c.estimate <= 4.0 * c.error);
        }
    }
}

TEST_CASE("display mapping: wrinkles that the solver mesh lacks cost no more than their share of the thickness") {
    // Wrinkles take part in the stiffness: a body with them, solved as it is, differs from the smooth one by the order of their height over
    // the radius, whatever the mapping does. 3 % high, eight rows of vertices to a wave.
    shapes::Body body = shapes::cylinder(0.5, 2.0, 28, 24);
    const TriangleMesh smooth = body.mesh;
    const double height = 0.015, radius = 0.5;
    body.mesh.vertices = wrinkled(smooth, held(body), height, 0.66);
    const std::vector<Field> poses = {kPull, kBend};
    const shapes::Body even{smooth, body.ends};
    const DecimatedBody small = decimate(smooth, facesOf(even), 300, {}).value();
    const Eigen::MatrixXd coarse = solved(small.mesh, small.faces, 0.45, poses);
    const auto plain = bothWays(even, small, coarse, 0.45, poses), wrinkles = bothWays(body, small, coarse, 0.45, poses);
    for (std::size_t k = 0; k < poses.size(); ++k) {
        MESSAGE("error ", wrinkles[k].error, ", without wrinkles ", plain[k].error, ", estimate ", wrinkles[k].estimate, ", shape ", wrinkles[k].shape);
        CHECK(wrinkles[k].error <= plain[k].error + wrinkles[k].shape);
        // rms of a wave; a cylinder of length 4 radii has 2 V / A = 0.8 radii.
        CHECK(wrinkles[k].shape == doctest::Approx(height / std::sqrt(2.0) / (0.8 * radius)).epsilon(0.2));
    }
}

TEST_CASE("display mapping: a thin plate's sides follow their own sides") {
    const shapes::Body plate = shapes::box(Vec3(0, 0, 0), Vec3(1, 0.01, 1), 20, 1, 20);
    const shapes::Body coarse = shapes::box(Vec3(0, 0, 0), Vec3(1, 0.01, 1), 7, 1, 7);
    TriangleMesh display = plate.mesh;
    // Each side's own vertices lie nearer to the other side of the solver mesh.
    for (Eigen::Index v = 0; v < display.vertices.rows(); ++v) display.vertices(v, 1) = display.vertices(v, 1) > 0.005 ? 0.0045 : 0.0055;
    display.triangles = plate.mesh.triangles;
    const auto map = DisplayMapping::build({&display, {}, &coarse.mesh, {}, 1}, {}).value();
    const Field apart = [](const Vec3& p) { return Vec3(p.y() > 0.005 ? 1.0 : -1.0, 0, 0); };
    const auto mapped = map.apply(sample(coarse.mesh.vertices, apart), 0.0, 1, {}).value();
    const Points normals = vertexNormals(display);
    for (std::size_t i = 0; i < map.vertices().size(); ++i) {
        const Eigen::Index v = map.vertices()[i];
        const Vec3 p = display.vertices.row(v);
        if (p.x() < 0.2 || p.x() > 0.8 || p.z() < 0.2 || p.z() > 0.8) continue;
        CHECK(mapped.displacement(3 * static_cast<Eigen::Index>(i), 0) * normals(v, 1) >= 0.9);
    }
}

TEST_CASE("display mapping: continuous across edges and corners of the solver mesh") {
    const shapes::Body solver = shapes::sphere(1.0, 2);
    const Field field = [](const Vec3& p) { return Vec3(p.x() * p.y(), std::sin(3.0 * p.z()), p.x() - p.y() * p.z()); };
    // Rows of display vertices just outside, 1e-6 apart, which cross many edges.
    TriangleMesh display;
    const int count = 4000;
    display.vertices.resize(count, 3);
    display.triangles.resize(0, 3);
    for (int i = 0; i < count; ++i) {
        const double t = 0.4 + 1e-3 * (i / 2) + 1e-6 * (i % 2);
        display.vertices.row(i) = 1.01 * Vec3(std::cos(t), std::sin(t) * std::cos(0.3 * t), std::sin(t) * std::sin(0.3 * t)).transpose();
    }
    const auto map = DisplayMapping::build({&display, {}, &solver.mesh, {}, 1}, {}).value();
    const auto mapped = map.apply(sample(solver.mesh.vertices, field), 0.45, 1, {}).value();
    for (int i = 0; i < count; i += 2)
        CHECK((mapped.displacement.block<3, 1>(3 * i, 0) - mapped.displacement.block<3, 1>(3 * i + 3, 0)).norm() <= 20.0 * 1e-6);  // slopes are about 3
}

TEST_CASE("display mapping: the same bytes for any number of threads, and several columns at once are the columns one by one") {
    const shapes::Body display = shapes::sphere(1.0, 5), solver = shapes::sphere(1.0, 3);
    const auto one = DisplayMapping::build({&display.mesh, {}, &solver.mesh, {}, 1}, {}).value();
    const auto three = DisplayMapping::build({&display.mesh, {}, &solver.mesh, {}, 3}, {}).value();
    Eigen::MatrixXd u(3 * solver.mesh.vertices.rows(), 3);
    u.col(0) = sample(solver.mesh.vertices, [](const Vec3& p) { return Vec3(p.x() * p.y(), p.z(), 1); });
    u.col(1) = sample(solver.mesh.vertices, [](const Vec3& p) { return Vec3(p.norm(), p.z() * p.z(), -p.x()); });
    u.col(2).setZero();
    const auto a = one.apply(u, 0.45, 1, {}).value(), b = three.apply(u, 0.45, 3, {}).value();
    CHECK(a.displacement == b.displacement);
    CHECK(a.error == b.error);
    CHECK(a.largestError == b.largestError);
    CHECK(a.error[2] == 0.0);
    CHECK(one.apply(u.col(1), 0.45, 1, {}).value().displacement == a.displacement.col(1));
}

TEST_CASE("display mapping: bad input is refused with a reason") {
    const shapes::Body body = shapes::sphere(1.0, 2);
    const auto n = static_cast<std::size_t>(body.mesh.vertices.rows());
    const std::vector<char> few(n - 1), all(n, 1);
    CHECK(DisplayMapping::build({&body.mesh, few, &body.mesh, {}, 1}, {}).error().code == "bad-value");
    std::vector<std::int32_t> every;
    for (std::int32_t t = 0; t < body.mesh.triangles.rows(); ++t) every.push_back(t);
    CHECK(DisplayMapping::build({&body.mesh, {}, &body.mesh, every, 1}, {}).error().code == "no-free-surface");
    every.assign(1, 100000);
    CHECK(DisplayMapping::build({&body.mesh, {}, &body.mesh, every, 1}, {}).error().code == "bad-value");
    TriangleMesh wild = body.mesh;
    wild.triangles(0, 0) = -1;
    CHECK(DisplayMapping::build({&body.mesh, {}, &wild, {}, 1}, {}).error().code == "bad-value");
    wild = body.mesh;
    wild.vertices(0, 0) = std::numeric_limits<double>::infinity();
    CHECK(DisplayMapping::build({&wild, {}, &body.mesh, {}, 1}, {}).error().code == "bad-value");

    const auto nothing = DisplayMapping::build({&body.mesh, all, &body.mesh, {}, 1}, {}).value();
    CHECK(nothing.vertices().empty());
    const Eigen::MatrixXd u = Eigen::MatrixXd::Ones(3 * body.mesh.vertices.rows(), 2);
    CHECK(nothing.apply(u, 0.3, 1, {}).value().displacement.rows() == 0);
    const auto map = DisplayMapping::build({&body.mesh, {}, &body.mesh, {}, 1}, {}).value();
    CHECK(map.apply(u.topRows(5), 0.3, 1, {}).error().code == "bad-value");
    CHECK(map.apply(u, 0.7, 1, {}).error().code == "bad-value");
    Eigen::MatrixXd nan = u;
    nan(0, 0) = std::numeric_limits<double>::quiet_NaN();
    CHECK(map.apply(nan, 0.3, 1, {}).error().code == "bad-value");
    CHECK(map.apply(u, 0.3, 1, {}).value().displacement.isApprox(u, 1e-14));
    std::stop_source stop;
    stop.request_stop();
    const Progress stopped({}, stop.get_token());
    CHECK(DisplayMapping::build({&body.mesh, {}, &body.mesh, {}, 1}, stopped).error().code == kCancelled);
    CHECK(map.apply(u, 0.3, 1, stopped).error().code == kCancelled);
}
