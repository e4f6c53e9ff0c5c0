// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/repair.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/body/body.h"
#include "tests/body/messes.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

bool has(const std::vector<MeshIssue>& issues, std::string_view code) {
    return std::any_of(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
}

SurfaceReport examined(const TriangleMesh& mesh, std::vector<RepairAction> steps = {}) {
    auto report = examineSurface(mesh, {}, steps);
    REQUIRE_MESSAGE(report.has_value(), report.error().message);
    return std::move(*report);
}

}  // namespace

TEST_CASE("repair: each action mends its issue and nothing else") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    struct Case {
        TriangleMesh mesh;
        const char* issue;
        RepairAction action;
    };
    const std::vector<Case> cases{{exploded(ball, 1.0), "unwelded", RepairAction::Weld},
                                  {without(ball, {0, 7, 100}), "open", RepairAction::Fill},
                                  {broken(ball, 3, 0.0, 0.2, 0.0, 0.0), "mixed-winding", RepairAction::Orient},
                                  {inverted(ball), "inverted", RepairAction::Orient},
                                  {broken(ball, 3, 0.0, 0.0, 0.2, 0.0), "duplicate-triangle", RepairAction::Drop}};
    for (const Case& c : cases) {
        CAPTURE(c.issue);
        const SurfaceReport r = examined(c.mesh, {c.action});
        CHECK(has(r.found, c.issue));
        CHECK(has(r.done, c.issue));
        CHECK(r.left.empty());
    }
    CHECK(examined(ball, {RepairAction::Fill}).done.empty());
    CHECK(has(examined(without(exploded(ball, 1.0), {3}), {RepairAction::Weld}).left, "open"));
}

TEST_CASE("repair: surfaces that touch in a vertex are separated") {
    // Two cubes, corner on corner.
    const TriangleMesh cube = shapes::box(Vec3::Zero(), Vec3::Ones(), 1, 1, 1).mesh, other = moved(cube, 1.0, Vec3::Ones());
    TriangleMesh touching = both(cube, other);
    const std::int32_t last = static_cast<std::int32_t>(cube.vertices.rows());
    for (Eigen::Index i = 0; i < touching.triangles.size(); ++i) {
        std::int32_t& v = touching.triangles.data()[i];
        for (std::int32_t w = 0; w < last; ++w)
            if (v >= last && touching.vertices.row(w) == touching.vertices.row(v)) v = w;
    }
    const SurfaceReport r = examined(touching, {RepairAction::Separate});
    CHECK(has(r.found, "non-manifold-vertex"));
    CHECK(!has(r.left, "non-manifold-vertex"));
}

TEST_CASE("repair: names, issues and refusals") {
    for (const RepairAction action : {RepairAction::Weld, RepairAction::Drop, RepairAction::Separate, RepairAction::Orient, RepairAction::Fill, RepairAction::Wrap})
        CHECK(repairActionOf(nameOf(action)) == action);
    CHECK(!repairActionOf("sew"));
    CHECK(repairFor("open") == RepairAction::Fill);
    CHECK(!repairFor("huge"));
    TriangleMesh bad = shapes::sphere(1.0, 1).mesh;
    bad.vertices(0, 0) = std::numeric_limits<double>::infinity();
    CHECK(examineSurface(bad, {}).error().code == "non-finite");
    CHECK(examineSurface({}, {}).error().code == "empty-mesh");
}

namespace {

const MeshIssue* withCode(const std::vector<MeshIssue>& issues, std::string_view code) {
    const auto it = std::find_if(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
    return it == issues.end() ? nullptr : &*it;
}

}  // namespace

TEST_CASE("examine: seams are one issue, and what is open besides has its own places") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    CHECK(examined(ball).found.empty());
    const SurfaceReport seams = examined(exploded(ball, 1.0));
    REQUIRE(seams.found.size() == 1);
    CHECK(seams.found[0].code == "unwelded");
    CHECK(seams.found[0].count == 3 * ball.triangles.rows() - ball.vertices.rows());

    const TriangleMesh torn = exploded(without(ball, {7}), 1.0);
    const SurfaceReport both = examined(torn, {RepairAction::Fill});
    const MeshIssue* open = withCode(both.found, "open");
    REQUIRE(open != nullptr);
    CHECK(open->count == 1);
    CHECK(open->triangles.size() == 3);  // around the hole
    for (const std::int32_t t : open->triangles) CHECK((t >= 0 && t < torn.triangles.rows()));
    CHECK(withCode(both.done, "open") != nullptr);
    CHECK(withCode(both.done, "open")->triangles == open->triangles);
    CHECK(withCode(both.left, "unwelded") != nullptr);  // nobody asked for it
    CHECK(withCode(both.left, "open") == nullptr);
    CHECK(examined(torn, {RepairAction::Weld, RepairAction::Fill}).left.empty());
}

TEST_CASE("examine: collapsed and turned triangles, copies and unused vertices are shown where they are") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    TriangleMesh mesh = withTriangle(ball, 3, 3, 4);
    mesh = withTriangle(mesh, ball.triangles(5, 0), ball.triangles(5, 1), ball.triangles(5, 2));
    mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
    mesh.vertices.bottomRows(1).setConstant(std::numeric_limits<double>::quiet_NaN());  // of no triangle
    const SurfaceReport r = examined(mesh, {RepairAction::Drop});
    const auto collapsed = static_cast<std::int32_t>(ball.triangles.rows());
    REQUIRE(withCode(r.found, "degenerate") != nullptr);
    CHECK(withCode(r.found, "degenerate")->triangles == std::vector{collapsed});
    REQUIRE(withCode(r.found, "duplicate-triangle") != nullptr);
    CHECK(withCode(r.found, "duplicate-triangle")->triangles == std::vector{collapsed + 1});
    REQUIRE(withCode(r.found, "unused-vertex") != nullptr);
    CHECK(withCode(r.found, "unused-vertex")->vertices == std::vector{static_cast<std::int32_t>(ball.vertices.rows())});
    CHECK(r.left.empty());
    CHECK(r.done.size() == 3);
    for (const MeshIssue& issue : r.found) CHECK(issue.severity != Severity::Error);
    // A strip with one side cannot be turned.
    TriangleMesh strip;
    strip.vertices.resize(12, 3);
    for (int i = 0; i < 6; ++i) {
        const double a = i * EIGEN_PI / 3.0, half = a / 2.0;
        const Vec3 middle(std::cos(a), std::sin(a), 0.0), across = 0.3 * (std::cos(half) * middle + std::sin(half) * Vec3::UnitZ());
        strip.vertices.row(2 * i) = middle + across;
        strip.vertices.row(2 * i + 1) = middle - across;
    }
    strip.triangles.resize(12, 3);
    for (int i = 0; i < 6; ++i) {
        const int a = 2 * i, b = a + 1, c = i < 5 ? a + 2 : 1, d = i < 5 ? a + 3 : 0;
        strip.triangles.row(2 * i) << a, c, b;
        strip.triangles.row(2 * i + 1) << b, c, d;
    }
    CHECK(withCode(examined(strip, {RepairAction::Orient}).left, "non-orientable") != nullptr);
    const auto body = makeBody(strip, {}, {BodyKind::Auto, 0.05}, {});
    REQUIRE_MESSAGE(body.has_value(), body.error().message);
    CHECK(body->report.how == BodyKind::Wrapped);
    REQUIRE(withCode(body->report.issues, "non-orientable") != nullptr);
    CHECK(withCode(body->report.issues, "non-orientable")->fixed);  // by the wrap
    CHECK(examineSurface({}, {}).error().code == "empty-mesh");
}

TEST_CASE("examine: whatever is broken, places are those of the mesh") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    for (unsigned seed = 0; seed < 20; ++seed) {
        CAPTURE(seed);
        const TriangleMesh mesh = broken(seed % 2 == 0 ? ball : exploded(ball, 1.0), seed, 0.05, 0.1, 0.05, seed % 3 == 0 ? 0.05 : 0.0);
        const SurfaceReport r = examined(mesh, {RepairAction::Weld, RepairAction::Drop, RepairAction::Separate, RepairAction::Orient, RepairAction::Fill});
        CHECK(!r.found.empty());
        for (const auto* issues : {&r.found, &r.done, &r.left})
            for (const MeshIssue& issue : *issues) {
                CHECK(std::all_of(issue.triangles.begin(), issue.triangles.end(), [&](std::int32_t t) { return t >= 0 && t < mesh.triangles.rows(); }));
                CHECK(std::all_of(issue.vertices.begin(), issue.vertices.end(), [&](std::int32_t v) { return v >= 0 && v < mesh.vertices.rows(); }));
            }
    }
}
