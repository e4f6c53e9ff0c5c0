// SPDX-License-Identifier: GPL-3.0-or-later
// Wraps of figures whose limbs are near each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/body/body.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/winding_number.h"
#include "tests/body/messes.h"
#include "tests/support/capsules.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

struct Figure {
    TriangleMesh mesh;
    std::vector<Vec3> between;  ///< places between its limbs, outside
    std::vector<Vec3> inside;
};

/// Each capsule as a shell of its own: those that flow into each other cross.
TriangleMesh shellsOf(const std::vector<capsules::Capsule>& flesh, double sides) {
    TriangleMesh out;
    for (const capsules::Capsule& c : flesh) {
        const TriangleMesh shell = capsules::surface({c}, 6.0 * std::max(c.radius, c.tipRadius) / sides);
        out = out.triangles.rows() == 0 ? shell : both(out, shell);
    }
    return out;
}

/// 1.8 m high, with legs, arms along the trunk, m apart from each other and from it.
Figure standing(double apart, double sides) {
    const double leg = 0.08, arm = 0.04, x = leg + apart / 2, side = 0.17 + apart + arm;
    Figure out;
    out.mesh = shellsOf({{{0, 1.1, 0}, {0, 1.4, 0}, 0.17, 0.17}, {{0, 1.5, 0}, {0, 1.7, 0}, 0.1, 0.1}, {{x, 1.0, 0}, {x, 0.08, 0}, leg, leg}, {{-x, 1.0, 0}, {-x, 0.08, 0}, leg, leg},
                                  {{0, 1.48, 0}, {side, 1.48, 0}, arm, arm}, {{side, 1.48, 0}, {side, 0.9, 0}, arm, arm},
                                  {{0, 1.48, 0}, {-side, 1.48, 0}, arm, arm}, {{-side, 1.48, 0}, {-side, 0.9, 0}, arm, arm}}, sides);
    for (const double y : {0.15, 0.3, 0.5, 0.7, 0.8}) out.between.emplace_back(0.0, y, 0.0);
    for (const double y : {1.1, 1.2, 1.3}) {
        out.between.emplace_back(0.17 + apart / 2, y, 0.0);
        out.between.emplace_back(-0.17 - apart / 2, y, 0.0);
    }
    for (const double y : {0.15, 0.5, 0.9}) out.inside.emplace_back(x, y, 0.0), out.inside.emplace_back(-x, y, 0.0);
    out.inside.emplace_back(0, 1.2, 0), out.inside.emplace_back(0, 1.6, 0), out.inside.emplace_back(side, 1.1, 0);
    return out;
}

/// A hand on an arm of 1 m with four fingers, m apart.
Figure hand(double apart, double sides) {
    const double finger = 0.012, step = 2 * finger + apart;
    Figure out;
    std::vector<capsules::Capsule> flesh{{{-1.0, 0, 0}, {-0.1, 0, 0}, 0.04, 0.03}, {{-0.1, 0, 0}, {0.0, 0, 0}, 0.03, 0.03}};
    for (int i = 0; i < 4; ++i) {
        const double z = (i - 1.5) * step;
        flesh.push_back({{-0.05, 0, z}, {0.08, 0, z}, finger, finger});
        out.inside.emplace_back(0.075, 0, z);
        out.inside.emplace_back(0.055, 0, z);
        if (i > 0)
            for (const double along : {0.05, 0.06, 0.075}) out.between.emplace_back(along, 0.0, z - step / 2);
    }
    out.inside.emplace_back(-0.5, 0, 0);
    out.mesh = shellsOf(flesh, sides);
    return out;
}

Body wrapped(const TriangleMesh& mess) {
    auto body = makeBody(mess, {}, {BodyKind::Wrapped, 0.0}, {});
    REQUIRE_MESSAGE(body.has_value(), body.error().message);
    return std::move(*body);
}

/// 2 for each ball, less 2 for each bridge between two places of one.
int eulerNumber(const TriangleMesh& mesh) {
    const EdgeTable edges(mesh.triangles);
    return static_cast<int>(mesh.vertices.rows()) - edges.size() + static_cast<int>(mesh.triangles.rows());
}

/// Flesh inside, air between the limbs, and no bridge anywhere.
void checkApart(const Figure& figure, const TriangleMesh& mess) {
    const Body body = wrapped(mess);
    CHECK(body.report.components == 1);
    CHECK(eulerNumber(body.mesh) == 2);
    for (const Vec3& p : figure.between) CHECK(std::abs(windingNumber(body.mesh, p)) < 1e-6);
    for (const Vec3& p : figure.inside) CHECK(windingNumber(body.mesh, p) == doctest::Approx(1.0));
}

/// Two limbs beside each other, m apart, along y.
TriangleMesh pair(double apart) { return shellsOf({{{0, 0, 0}, {0, 1, 0}, 0.1, 0.1}, {{0.2 + apart, 0, 0}, {0.2 + apart, 1, 0}, 0.1, 0.1}}, 8); }

}  // namespace

TEST_CASE("wrap: two round limbs near each other are joined nowhere, closed or of loose triangles") {
    const TriangleMesh limbs = pair(0.02);
    for (const TriangleMesh& mesh : {limbs, exploded(limbs, 0.9)}) {
        const Body body = wrapped(mesh);
        CHECK(body.report.components == 2);
        CHECK(eulerNumber(body.mesh) == 4);
        CHECK(std::abs(body.report.gaps.area) < 1e-3);
    }
}

TEST_CASE("wrap: a hole in a limb that is wider than the gap beside it closes no gap") {
    TriangleMesh limbs = pair(0.02);
    std::vector<std::int32_t> hole;  // the outer side of the first, 10 cm long and 5 cm wide
    for (std::int32_t f = 0; f < limbs.triangles.rows(); ++f) {
        const Vec3 p = (limbs.vertices.row(limbs.triangles(f, 0)) + limbs.vertices.row(limbs.triangles(f, 1)) + limbs.vertices.row(limbs.triangles(f, 2))).transpose() / 3.0;
        if (p.x() < -0.08 && std::abs(p.y() - 0.5) < 0.05) hole.push_back(f);
    }
    REQUIRE(!hole.empty());
    const Body body = wrapped(exploded(without(limbs, hole), 0.9));
    CHECK(body.report.components == 2);
    CHECK(eulerNumber(body.mesh) == 4);
    for (const double y : {0.1, 0.5, 0.9}) {
        CHECK(windingNumber(body.mesh, {0.0, y, 0.0}) == doctest::Approx(1.0));
        CHECK(std::abs(windingNumber(body.mesh, {0.11, y, 0.0})) < 1e-6);
    }
}

TEST_CASE("wrap: legs and arms of crossing shells in loose triangles stay apart") {
    const Figure figure = standing(0.02, 8);
    checkApart(figure, exploded(figure.mesh, 0.9));
}

TEST_CASE("wrap: fingers stay apart by a three hundredth of the arm") {
    const Figure figure = hand(0.004, 10);
    checkApart(figure, exploded(figure.mesh, 0.9));
}

TEST_CASE("wrap: a gap that is too narrow to be kept open is said, with its place") {
    const Body body = wrapped(exploded(pair(0.001), 0.9));
    CHECK(body.report.components == 1);
    REQUIRE(!body.report.gaps.places.empty());
    CHECK(std::abs(body.report.gaps.places.front().x() - 0.1) < 0.02);
    CHECK(std::any_of(body.report.issues.begin(), body.report.issues.end(), [](const MeshIssue& issue) { return issue.code == "closed-gap"; }));
}
