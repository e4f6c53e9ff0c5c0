// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/repair.h"

#include <doctest/doctest.h>

#include <limits>

#include "tests/body/messes.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

bool has(const std::vector<MeshIssue>& issues, std::string_view code) {
    return std::any_of(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
}

Repaired repaired(const TriangleMesh& mesh, RepairAction action) {
    auto result = repairSurface(mesh, {}, action, {});
    REQUIRE_MESSAGE(result.has_value(), result.error().message);
    return std::move(*result);
}

}  // namespace

TEST_CASE("repair: each action mends its issue and nothing else") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    struct Case {
        TriangleMesh mesh;
        const char* issue;
        RepairAction action;
    };
    const std::vector<Case> cases{{exploded(ball, 1.0), "open", RepairAction::Weld},
                                  {without(ball, {0, 7, 100}), "open", RepairAction::Fill},
                                  {broken(ball, 3, 0.0, 0.2, 0.0, 0.0), "mixed-winding", RepairAction::Orient},
                                  {inverted(ball), "inverted", RepairAction::Orient},
                                  {broken(ball, 3, 0.0, 0.0, 0.2, 0.0), "duplicate-triangle", RepairAction::Drop}};
    for (const Case& c : cases) {
        CAPTURE(c.issue);
        const Repaired r = repaired(c.mesh, c.action);
        CHECK(has(r.before, c.issue));
        CHECK(r.after.empty());
        CHECK(!r.done.empty());
        CHECK(r.part.size() == static_cast<std::size_t>(r.mesh.triangles.rows()));
        CHECK(meshFacts(r.mesh).volume == doctest::Approx(meshFacts(ball).volume).epsilon(0.02));
    }
    CHECK(repaired(ball, RepairAction::Fill).done.empty());
    CHECK(repaired(ball, RepairAction::Fill).mesh.triangles == ball.triangles);
    CHECK(has(repaired(without(exploded(ball, 1.0), {3}), RepairAction::Weld).after, "open"));
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
    const Repaired r = repaired(touching, RepairAction::Separate);
    CHECK(has(r.before, "non-manifold-vertex"));
    CHECK(!has(r.after, "non-manifold-vertex"));
    CHECK(meshFacts(r.mesh).closed);
}

TEST_CASE("repair: a wrap closes what nothing else closes") {
    const TriangleMesh loose = exploded(shapes::sphere(1.0, 2).mesh, 0.9);
    const Repaired r = repaired(loose, RepairAction::Wrap);
    CHECK(has(r.before, "open"));
    CHECK(meshFacts(r.mesh).outward);
    CHECK(r.part.empty());
}

TEST_CASE("repair: names, issues and refusals") {
    for (const RepairAction action : {RepairAction::Weld, RepairAction::Drop, RepairAction::Separate, RepairAction::Orient, RepairAction::Fill, RepairAction::Wrap})
        CHECK(repairActionOf(nameOf(action)) == action);
    CHECK(!repairActionOf("sew"));
    CHECK(repairFor("open") == RepairAction::Fill);
    CHECK(!repairFor("huge"));
    TriangleMesh bad = shapes::sphere(1.0, 1).mesh;
    bad.vertices(0, 0) = std::numeric_limits<double>::infinity();
    CHECK(repairSurface(bad, {}, RepairAction::Weld, {}).error().code == "non-finite");
    CHECK(repairSurface({}, {}, RepairAction::Weld, {}).error().code == "empty-mesh");
}
