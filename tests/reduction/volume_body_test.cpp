// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/volume_body.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

JointFace smallPatch(const TriangleMesh& body, const Vec3& point, double radius) {
    const SurfacePoint place = nearestOnSurface(body, point);
    JointFace face = jointFaceByDisc(body, place.triangle, place.point, radius).value();
    face.disc = SurfaceDisc{place.point, radius};
    return face;
}

/// An egg of 2,562 vertices with three handles of about 6 % of its diagonal.
ResponseInput egg(const std::string& solverMesh) {
    const auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::moved(shapes::sphere(1.0, 4), Vec3(1.0, 0.8, 1.6).asDiagonal()).mesh;
    ResponseInput input;
    input.mesh = mesh;
    input.faces = {smallPatch(mesh->body, Vec3(0, 0, 1.6), 0.25), smallPatch(mesh->body, Vec3(1, 0, -0.3), 0.25), smallPatch(mesh->body, Vec3(0, 0, -1.6), 0.25)};
    input.basis = BasisKind::Affine;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    input.threads = 2;
    return input;
}

/// Relative difference of all joint modes together.
double difference(const ElementResponse& a, const ElementResponse& b) {
    REQUIRE(a.freeVertices == b.freeVertices);
    return (a.response - b.response).norm() / b.response.norm();
}

/// Of moves and turns of handles that are not flat, relative to free and held vertices together, root mean square: as ResponseQuality::error is meant.
double differenceOfMotions(const ResponseInput& input, const ElementResponse& a, const ElementResponse& b) {
    REQUIRE(a.freeVertices == b.freeVertices);
    std::size_t held = 0;
    for (const JointFace& face : input.faces) held += face.vertices.size();
    double sum = 0.0;
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        REQUIRE(b.bases[f].columns() == 12);
        const int c = b.firstColumn[f];
        // Columns of the affine basis (FaceBasis) that move the face, and that turn it about its x, y and z.
        for (const auto& [plus, minus] : {std::pair(5, -1), {6, -1}, {7, -1}, {4, 10}, {9, 3}, {8, -1}}) {
            const auto of = [plus = plus, minus = minus](const Eigen::MatrixXd& columns) {
                Eigen::VectorXd out = columns.col(plus);
                if (minus >= 0) out -= columns.col(minus);
                return out;
            };
            double moved = 0.0;
            for (const std::int32_t v : input.faces[f].vertices)
                moved += of(b.bases[f].at(input.faces[f].frame.toLocal(input.mesh->body.vertices.row(v).transpose()))).squaredNorm();
            const Eigen::VectorXd wanted = of(b.response.middleCols(c, 12)), found = of(a.response.middleCols(c, 12));
            const double all = static_cast<double>(wanted.size());
            sum += (found - wanted).squaredNorm() / all / (wanted.squaredNorm() / all + moved / (3.0 * static_cast<double>(held)));
        }
    }
    return std::sqrt(sum / (6.0 * static_cast<double>(input.faces.size())));
}

}  // namespace

TEST_CASE("volume body: with handles a draft is within a tenth of the default, symmetric, and states its error") {
    const auto exact = buildResponse(egg("default"), {}), draft = buildResponse(egg("draft"), {});
    REQUIRE(exact);
    REQUIRE(draft);
    const double error = differenceOfMotions(egg("draft"), *draft, *exact);
    MESSAGE("draft: ", 100.0 * error, " %, stated ", 100.0 * draft->quality.error, " %, ", draft->quality.solverNodes, " nodes, ", draft->quality.seconds, " s; default states ",
            100.0 * exact->quality.error, " %, ", exact->quality.solverNodes, " nodes, ", exact->quality.seconds, " s");
    CHECK(difference(*draft, *exact) <= 0.1);
    // An estimate from two levels, and the default has an error of its own.
    CHECK(draft->quality.error >= error / 1.5);
    CHECK(draft->quality.error <= 4.0 * error);
    CHECK(exact->quality.error < draft->quality.error);
    for (const ElementResponse* response : {&*exact, &*draft}) {
        CHECK(response->quality.tetrahedra > 0);
        CHECK(response->quality.noFilling.empty());
        CHECK(response->quality.asymmetry <= 1e-9);
        CHECK(response->quality.negativeEnergy >= -1e-9);
    }
}

TEST_CASE("volume body: needles, as cuts close by vertices leave them, are solved without, and the answer is that of the body without needles") {
    const shapes::Body box = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 2), 3, 3, 6);
    TriangleMesh needled = box.mesh;
    const auto isEnd = [&](Eigen::Index t) { return std::ranges::any_of(box.ends, [&](const auto& end) { return std::ranges::count(end.triangles, t) > 0; }); };
    int needles = 0;
    // A vertex a hundred-thousandth of an edge beside a corner, within a triangle of the side.
    for (Eigen::Index t = 0; t < box.mesh.triangles.rows(); ++t) {
        if (t % 3 != 0 || isEnd(t)) continue;
        const auto corner = [&](int c) -> Vec3 { return box.mesh.vertices.row(box.mesh.triangles(t, c)).transpose(); };
        const auto v = static_cast<std::int32_t>(needled.vertices.rows());
        const Eigen::RowVector3i old = box.mesh.triangles.row(t);
        needled.vertices.conservativeResize(v + 1, 3);
        needled.vertices.row(v) = (corner(0) + 1e-5 * (corner(1) + corner(2) - 2.0 * corner(0))).transpose();
        needled.triangles.row(t) << old[0], old[1], v;
        needled.triangles.conservativeResize(needled.triangles.rows() + 2, 3);
        needled.triangles.bottomRows(2) << old[1], old[2], v, old[2], old[0], v;
        ++needles;
    }
    REQUIRE(needles > 20);
    const auto solved = [&](const TriangleMesh& body) {
        ResponseInput input;
        const auto mesh = std::make_shared<ElementMesh>();
        mesh->body = body;
        input.mesh = mesh;
        for (const auto& end : box.ends) input.faces.push_back(jointFaceByTriangles(mesh->body, end.triangles).value());
        input.solverMesh = parseSolverMesh("default").value();
        const auto solid = solvedBody(body, input.faces, input.solverMesh, {});
        REQUIRE(solid);
        CHECK(solid->noFilling == "");
        double shortest = HUGE_VAL;
        const TriangleMesh& surface = solid->mesh.mesh;
        for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
            for (int c = 0; c < 3; ++c) shortest = std::min(shortest, (surface.vertices.row(surface.triangles(t, c)) - surface.vertices.row(surface.triangles(t, (c + 1) % 3))).norm());
        CHECK(shortest > 1e-3);
        auto response = buildResponse(input, {});
        REQUIRE(response);
        return std::move(*response);
    };
    const ElementResponse with = solved(needled), without = solved(box.mesh);
    CHECK(with.quality.solverNodes <= 1.2 * without.quality.solverNodes);
    // The same vertices come first in both.
    double largest = 0.0;
    for (std::size_t i = 0; i < without.freeVertices.size(); ++i) {
        const auto at = std::ranges::find(with.freeVertices, without.freeVertices[i]) - with.freeVertices.begin();
        REQUIRE(static_cast<std::size_t>(at) < with.freeVertices.size());
        largest = std::max(largest, (with.response.middleRows(3 * at, 3) - without.response.middleRows(3 * static_cast<Eigen::Index>(i), 3)).norm());
    }
    CHECK(largest <= 0.03 * without.response.rowwise().norm().maxCoeff());  // each is within a percent of the truth
}

TEST_CASE("volume body: at ratios that tetrahedra cannot take, and where a body cannot be filled, boundary elements solve it and say why") {
    for (const char* setting : {"volume:600", "draft", "default"}) {
        const ResponseInput input = egg(setting);
        const auto solid = solvedBody(input.mesh->body, input.faces, input.solverMesh, {}, false);
        REQUIRE(solid);
        CHECK(!solid->filling);
        CHECK(solid->noFilling.find("0.49") != std::string::npos);
    }
    CHECK(solvedBody(egg("as-is").mesh->body, egg("as-is").faces, parseSolverMesh("as-is").value(), {}, false).value().noFilling.empty());
    // Two overlapping boxes are closed, but meet each other.
    const auto mesh = std::make_shared<ElementMesh>();
    const shapes::Body one = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 2), 2, 2, 4), other = shapes::box(Vec3(0.6, 0.3, 0.7), Vec3(1.6, 0.8, 1.2), 1, 1, 1);
    mesh->body.vertices.resize(one.mesh.vertices.rows() + other.mesh.vertices.rows(), 3);
    mesh->body.vertices << one.mesh.vertices, other.mesh.vertices;
    mesh->body.triangles.resize(one.mesh.triangles.rows() + other.mesh.triangles.rows(), 3);
    mesh->body.triangles << one.mesh.triangles, other.mesh.triangles.array() + static_cast<std::int32_t>(one.mesh.vertices.rows());
    const std::vector<JointFace> faces = {jointFaceByTriangles(mesh->body, one.ends[0].triangles).value()};
    const auto crossed = solvedBody(mesh->body, faces, parseSolverMesh("volume:5000").value(), {});
    REQUIRE(crossed);
    CHECK(!crossed->filling);
    CHECK(crossed->noFilling.find("filled") != std::string::npos);
}

TEST_CASE("volume body: the body itself is filled where as-is or refined have more than 5,000 vertices, and all its vertices stay") {
    const ResponseInput input = egg("refined:6000");
    const Points& own = input.mesh->body.vertices;
    const auto large = solvedBody(input.mesh->body, input.faces, input.solverMesh, {});
    REQUIRE(large);
    REQUIRE(large->filling);
    CHECK_FALSE(large->decimated);
    CHECK(large->noFilling.empty());
    CHECK(large->mesh.mesh.vertices.topRows(own.rows()) == own);
    const auto usual = solvedBody(input.mesh->body, input.faces, parseSolverMesh("refined:5000").value(), {});
    REQUIRE(usual);
    CHECK_FALSE(usual->filling);
    CHECK(usual->mesh.mesh.vertices.rows() == 5000);
}

TEST_CASE("volume body: flesh that hangs from two faces close together moves in a draft of tetrahedra as with twice as many, within what it states") {
    const auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::moved(shapes::sphere(1.0, 3), Vec3(0.8, 0.8, 1.6).asDiagonal()).mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const double side : {-0.45, 0.45}) {
        input.faces.push_back(smallPatch(mesh->body, Vec3(side, 0, 1.4), 0.35));
        input.faces.back().disc.reset();  // a cut's: its triangles are held
    }
    input.basis = BasisKind::Affine;
    input.solverMesh = parseSolverMesh("draft").value();
    input.threads = 2;
    const auto draft = buildResponse(input, {});
    input.solverMesh = parseSolverMesh("volume:1200").value();
    const auto fine = buildResponse(input, {});
    REQUIRE(draft);
    REQUIRE(fine);
    CHECK(draft->quality.tetrahedra > 0);
    CHECK(fine->quality.tetrahedra > draft->quality.tetrahedra);
    const double apart = difference(*draft, *fine);
    MESSAGE("draft: ", 100.0 * apart, " %, stated ", 100.0 * draft->quality.error, " %, ", draft->quality.seconds, " s; with 1,200 vertices ", 100.0 * fine->quality.error, " %, ", fine->quality.seconds, " s");
    CHECK(apart <= 0.1);
    CHECK(draft->quality.error >= apart / 1.5);
    CHECK(draft->quality.error <= 0.2);
}

TEST_CASE("volume body: a bar with flat faces, its weight and touch agree with boundary elements within what both state") {
    const auto mesh = std::make_shared<ElementMesh>();
    const shapes::Body bar = shapes::cylinder(0.5, 2.0, 16, 8);
    mesh->body = bar.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const shapes::Patch& end : bar.ends) input.faces.push_back(jointFaceByTriangles(mesh->body, end.triangles).value());
    input.basis = BasisKind::Affine;
    input.nu = 0.45;
    input.loads = BodyLoads::Always;
    input.touch = 6;
    input.threads = 2;
    input.solverMesh = parseSolverMesh("default").value();
    const auto boundary = buildResponse(input, {});
    input.solverMesh = parseSolverMesh("volume:1500").value();
    const auto volume = buildResponse(input, {});
    REQUIRE(boundary);
    REQUIRE_MESSAGE(volume, volume.error().message);
    CHECK(volume->quality.tetrahedra > 0);
    const double stated = boundary->quality.error + volume->quality.error, apart = difference(*volume, *boundary);
    MESSAGE("boundary elements state ", 100.0 * boundary->quality.error, " %, finite elements ", 100.0 * volume->quality.error, " %; they differ by ", 100.0 * apart, " %");
    CHECK(apart <= stated);
    CHECK((volume->stiffness - boundary->stiffness).norm() <= 0.03 * boundary->stiffness.norm());
    CHECK((volume->loads - boundary->loads).norm() <= 0.02 * boundary->loads.norm());
    CHECK((volume->loadForces - boundary->loadForces).norm() <= 0.02 * boundary->loadForces.norm());
    REQUIRE(volume->touch.patches.count() == boundary->touch.patches.count());
    CHECK((volume->touch.compliance - boundary->touch.compliance).norm() <= 0.03 * boundary->touch.compliance.norm());
    CHECK((volume->touch.forces - boundary->touch.forces).norm() <= 0.03 * boundary->touch.forces.norm());
    CHECK(volume->touch.asymmetry <= 1e-9);
}

TEST_CASE("volume body: a piece that hangs from two ends of a limb has small tetrahedra at its rims alone, and its draft and default state their errors") {
    const auto mesh = std::make_shared<ElementMesh>();
    const shapes::Body limb = shapes::cylinder(0.5, 1.5, 20, 8);
    mesh->body = limb.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const shapes::Patch& end : limb.ends) input.faces.push_back(jointFaceByTriangles(mesh->body, end.triangles).value());
    input.basis = BasisKind::Affine;
    input.threads = 2;
    const auto with = [&](const std::string& solverMesh) {
        ResponseInput asked = input;
        asked.solverMesh = parseSolverMesh(solverMesh).value();
        return asked;
    };
    const std::vector<ResponseInput> asked = {with("draft"), with("default"), with("best")};
    std::vector<ElementResponse> made(asked.size());
    buildResponses(asked, 2, [&](std::size_t i, Result<ElementResponse> response) { made[i] = response.value(); }, {});
    const ElementResponse &draft = made[0], &byDefault = made[1], &best = made[2];
    const auto even = buildResponse(with("volume:2500"), {});
    REQUIRE(even);
    // The largest over the joint modes, relative to free and held vertices together.
    const auto error = [&](const ElementResponse& response) {
        const double held = static_cast<double>(limb.mesh.vertices.rows()) - static_cast<double>(best.freeVertices.size());
        double largest = 0.0;
        for (std::size_t f = 0; f < input.faces.size(); ++f)
            for (int c = 0; c < best.bases[f].columns(); ++c) {
                double moved = 0.0;
                for (const std::int32_t v : input.faces[f].vertices)
                    moved += best.bases[f].at(input.faces[f].frame.toLocal(mesh->body.vertices.row(v).transpose())).col(c).squaredNorm();
                const auto column = best.firstColumn[f] + c;
                const double rows = static_cast<double>(best.response.rows());
                largest = std::max(largest, (response.response.col(column) - best.response.col(column)).squaredNorm() / rows / (best.response.col(column).squaredNorm() / rows + moved / (3.0 * held)));
            }
        return std::sqrt(largest);
    };
    MESSAGE("draft: ", 100.0 * error(draft), " %, stated ", 100.0 * draft.quality.error, " %, ", draft.quality.tetrahedra, " tetrahedra; default: ", 100.0 * error(byDefault), " %, stated ",
            100.0 * byDefault.quality.error, " %, ", byDefault.quality.tetrahedra, "; small ones everywhere: ", 100.0 * error(*even), " %, ", even->quality.tetrahedra);
    CHECK(error(draft) <= 0.05);
    CHECK(error(byDefault) <= 0.01);
    CHECK(error(byDefault) <= error(*even));
    CHECK(byDefault.quality.tetrahedra < even->quality.tetrahedra);
    CHECK(draft.quality.tetrahedra < byDefault.quality.tetrahedra / 3);
    CHECK(draft.quality.error >= error(draft) / 1.5);
    CHECK(draft.quality.error <= 3.0 * error(draft));
    CHECK(byDefault.quality.error >= error(byDefault) / 1.5);
    // Many at once have the bytes that each has alone.
    const auto alone = buildResponse(asked[0], {});
    REQUIRE(alone);
    CHECK(alone->response == draft.response);
    CHECK(alone->stiffness == draft.stiffness);
    // What an estimate of time and memory goes by.
    const SolvedSize size = solvedSize(mesh->body, input.faces, asked[1].solverMesh);
    CHECK(size.nodes > byDefault.quality.solverNodes / 2);
    CHECK(size.nodes < 2 * byDefault.quality.solverNodes);
}

TEST_CASE("volume body: one with more vertices than it may have at most is not filled, so that a coarser level never is the body itself") {
    ResponseInput input = egg("draft");
    for (JointFace& face : input.faces) face.disc.reset();
    const BodySurface surface(input.mesh->body, input.faces);
    VolumeDetail detail;
    detail.vertices = 1000;
    const auto small = volumeBody(surface, detail, {}, 1200);
    REQUIRE(small);
    CHECK(small->decimated);
    const auto most = static_cast<int>(input.mesh->body.vertices.rows()) - 1;
    detail.vertices = most;  // too near to what it has for a decimation
    const auto large = volumeBody(surface, detail, {}, most);
    REQUIRE_FALSE(large);
    CHECK(large.error().code == "no-filling");
    CHECK(volumeBody(surface, detail, {}));
}
