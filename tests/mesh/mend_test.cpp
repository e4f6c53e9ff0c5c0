// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include "core/mesh/cgal/fill_hole.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/mend.h"
#include "core/mesh/winding_number.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

RawSurface surface(const TriangleMesh& mesh) {
    RawSurface s;
    s.mesh.body = mesh;
    s.part.assign(static_cast<std::size_t>(mesh.triangles.rows()), 0);
    return s;
}

TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh m;
    m.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    m.vertices << a.vertices, b.vertices;
    m.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    m.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return m;
}

TriangleMesh scaled(TriangleMesh m, double s) {
    m.vertices *= s;
    return m;
}

TriangleMesh inverted(TriangleMesh m) {
    m.triangles.col(1).swap(m.triangles.col(2));
    return m;
}

/// Every triangle with vertices of its own, as STL has it.
TriangleMesh exploded(const TriangleMesh& m) {
    TriangleMesh e;
    e.vertices.resize(m.triangles.rows() * 3, 3);
    e.triangles.resize(m.triangles.rows(), 3);
    for (Eigen::Index i = 0; i < m.triangles.size(); ++i) {
        e.vertices.row(i) = m.vertices.row(m.triangles.data()[i]);
        e.triangles.data()[i] = static_cast<std::int32_t>(i);
    }
    return e;
}

TriangleMesh without(const TriangleMesh& m, const std::vector<std::int32_t>& triangles) {
    TriangleMesh r;
    r.vertices = m.vertices;
    r.triangles.resize(m.triangles.rows() - static_cast<Eigen::Index>(triangles.size()), 3);
    Eigen::Index n = 0;
    for (std::int32_t f = 0; f < m.triangles.rows(); ++f)
        if (std::find(triangles.begin(), triangles.end(), f) == triangles.end()) r.triangles.row(n++) = m.triangles.row(f);
    return r;
}

const MeshIssue* find(const std::vector<MeshIssue>& issues, const std::string& code) {
    const auto it = std::find_if(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
    return it == issues.end() ? nullptr : &*it;
}

/// The one body, and that its render mesh fits it.
const MendedBody& only(const MendResult& r) {
    REQUIRE(r.bodies.size() == 1);
    return r.bodies[0];
}

void checkLook(const ElementMesh& mesh) {
    REQUIRE(mesh.renderMesh.triangles.rows() == mesh.body.triangles.rows());
    for (Eigen::Index i = 0; i < mesh.renderMesh.triangles.size(); ++i)
        REQUIRE(mesh.renderMesh.bodyVertex[static_cast<std::size_t>(mesh.renderMesh.triangles.data()[i])] == mesh.body.triangles.data()[i]);
}

}  // namespace

TEST_CASE("mending: a sound body stays as it is, to the bit") {
    for (const auto& body : {shapes::box({-1, -1, -1}, {1, 2, 3}, 2, 3, 4), shapes::sphere(1.0, 2), shapes::torus(2.0, 0.5, 24, 12), shapes::cylinder(1.0, 4.0, 16, 6)}) {
        const MendResult r = mend(surface(body.mesh), false);
        CHECK(r.mended.empty());
        CHECK(only(r).closed);
        CHECK(only(r).issues.empty());
        CHECK(only(r).mesh.body.vertices == body.mesh.vertices);
        CHECK(only(r).mesh.body.triangles == body.mesh.triangles);
        checkLook(only(r).mesh);
    }
}

TEST_CASE("mending: triangles without common vertices are welded to the first of them") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    TriangleMesh soup = exploded(ball);
    soup.vertices = (soup.vertices.array() == 0.0).select(-0.0, soup.vertices);  // -0 is 0
    const MendResult r = mend(surface(soup), false);
    CHECK(only(r).closed);
    CHECK(only(r).mesh.body.vertices.rows() == ball.vertices.rows());
    REQUIRE(find(r.mended, "unwelded"));
    CHECK(find(r.mended, "unwelded")->count == soup.vertices.rows() - ball.vertices.rows());
    CHECK(find(r.mended, "unwelded")->fixed);
    // The order of the file: new vertices in the order in which they are first used.
    std::int32_t next = 0;
    for (Eigen::Index i = 0; i < only(r).mesh.body.triangles.size(); ++i) {
        const std::int32_t v = only(r).mesh.body.triangles.data()[i];
        CHECK(v <= next);
        next = std::max(next, v + 1);
    }
}

TEST_CASE("mending: seams that were rounded apart are welded, at any scale") {
    for (const double scale : {1e-8, 1.0, 1e8}) {
        CAPTURE(scale);
        TriangleMesh soup = exploded(scaled(shapes::torus(2.0, 0.5, 24, 12).mesh, scale));
        std::mt19937 random(5);
        std::uniform_real_distribution<double> jitter(-1e-7 * scale, 1e-7 * scale);
        for (Eigen::Index i = 0; i < soup.vertices.size(); ++i) soup.vertices.data()[i] += jitter(random);
        const MendResult r = mend(surface(soup), false);
        CHECK(only(r).closed);
        CHECK(only(r).mesh.body.vertices.rows() == 24 * 12);
    }
}

TEST_CASE("mending: two closed bodies that touch are not welded to each other") {
    const TriangleMesh two = both(shapes::box({0, 0, 0}, {1, 1, 1}, 2, 2, 2).mesh, shapes::box({0, 0, 1}, {1, 1, 2}, 2, 2, 2).mesh);
    const MendResult r = mend(surface(two), true);
    REQUIRE(r.bodies.size() == 2);
    CHECK(r.bodies[0].closed);
    CHECK(r.bodies[1].closed);
    // Not even when they come in pieces, as long as each is a part of its own.
    RawSurface soup = surface(exploded(two));
    std::fill(soup.part.begin() + two.triangles.rows() / 2, soup.part.end(), 1);
    const MendResult parts = mend(std::move(soup), true);
    REQUIRE(parts.bodies.size() == 2);
    CHECK(parts.bodies[0].closed);
    CHECK(parts.bodies[1].closed);
    CHECK(parts.bodies[1].part == 1);
}

TEST_CASE("mending: one surface in parts is welded over their borders") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    RawSurface soup = surface(exploded(ball));
    for (std::size_t f = 0; f < soup.part.size(); ++f) soup.part[f] = static_cast<std::int32_t>(f % 3);
    const MendResult r = mend(std::move(soup), false);
    CHECK(only(r).closed);
    CHECK(only(r).mesh.body.vertices.rows() == ball.vertices.rows());
}

TEST_CASE("mending: turned triangles are turned back, the fewer follow the more") {
    CHECK(rc::check("any set of turned triangles", [] {
        const TriangleMesh ball = shapes::sphere(1.0, 1).mesh;
        TriangleMesh mixed = ball;
        for (Eigen::Index f = 0; f < mixed.triangles.rows(); ++f)
            if (*rc::gen::arbitrary<bool>()) std::swap(mixed.triangles(f, 1), mixed.triangles(f, 2));
        const MendResult r = mend(surface(mixed), false);
        RC_ASSERT(r.bodies.size() == 1U);
        RC_ASSERT(r.bodies[0].closed);
        RC_ASSERT(meshFacts(r.bodies[0].mesh.body).volume > 0.0);
    }));
}

TEST_CASE("mending: an inverted body is turned, and its normals with it") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    RawSurface s = surface(inverted(ball));
    RenderMesh& render = s.mesh.renderMesh;
    render.triangles = s.mesh.body.triangles;
    render.bodyVertex.resize(static_cast<std::size_t>(ball.vertices.rows()));
    std::iota(render.bodyVertex.begin(), render.bodyVertex.end(), 0);
    render.normals = -ball.vertices.cast<float>();
    const MendResult r = mend(std::move(s), false);
    CHECK(only(r).closed);
    REQUIRE(find(r.mended, "inverted"));
    checkLook(only(r).mesh);
    for (Eigen::Index v = 0; v < only(r).mesh.renderMesh.normals.rows(); ++v)
        CHECK(only(r).mesh.renderMesh.normals.row(v).cast<double>().dot(ball.vertices.row(only(r).mesh.renderMesh.bodyVertex[static_cast<std::size_t>(v)])) > 0.9);
}

TEST_CASE("mending: a cavity winds inward, what is in the cavity outward again, whatever the file says") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    for (int windings = 0; windings < 8; ++windings) {
        CAPTURE(windings);
        const auto shell = [&](double size, int bit) { return (windings >> bit) % 2 ? inverted(scaled(ball, size)) : scaled(ball, size); };
        const TriangleMesh nested = both(both(shell(1.0, 0), shell(0.6, 1)), shell(0.3, 2));
        const double whole = meshFacts(ball).volume * (1.0 - 0.216 + 0.027);
        const MendResult one = mend(surface(nested), false);
        CHECK(only(one).closed);
        CHECK(only(one).components == 3);
        CHECK(meshFacts(only(one).mesh.body).volume == doctest::Approx(whole).epsilon(1e-12));
        const MendResult split = mend(surface(nested), true);
        REQUIRE(split.bodies.size() == 2);  // the ball with its cavity, and the ball in it
        CHECK(split.bodies[0].closed);
        CHECK(split.bodies[0].components == 2);
        CHECK(split.bodies[1].closed);
        CHECK(split.bodies[1].components == 1);
    }
}

TEST_CASE("mending: holes are capped where the result is closed, and the cap has a render mesh") {
    auto tube = shapes::cylinder(1.0, 4.0, 16, 6);
    std::vector<std::int32_t> caps = tube.ends[0].triangles;
    caps.insert(caps.end(), tube.ends[1].triangles.begin(), tube.ends[1].triangles.end());
    RawSurface s = surface(without(tube.mesh, caps));
    RenderMesh& render = s.mesh.renderMesh;
    render.triangles = s.mesh.body.triangles;
    render.bodyVertex.resize(static_cast<std::size_t>(tube.mesh.vertices.rows()));
    std::iota(render.bodyVertex.begin(), render.bodyVertex.end(), 0);
    render.normals = vertexNormals(s.mesh.body).cast<float>();
    render.texCoords.setConstant(tube.mesh.vertices.rows(), 2, 0.25f);
    render.materials.resize(2);
    render.material.assign(static_cast<std::size_t>(render.triangles.rows()), 1);
    const MendResult r = mend(std::move(s), false);
    CHECK(only(r).closed);
    REQUIRE(find(r.mended, "open"));
    CHECK(find(r.mended, "open")->count == 2);
    checkLook(only(r).mesh);
    const double exact = meshFacts(tube.mesh).volume;
    CHECK(meshFacts(only(r).mesh.body).volume == doctest::Approx(exact).epsilon(1e-12));
    const RenderMesh& worn = only(r).mesh.renderMesh;
    CHECK(worn.materials.size() == 1);
    CHECK(static_cast<Eigen::Index>(worn.material.size()) == only(r).mesh.body.triangles.rows());
    CHECK((worn.texCoords.array() == 0.25f).all());
    const Eigen::Index last = worn.triangles.rows() - 1;  // of a cap: its normal is that of the flat end
    const Vec3 flat = areaVector(only(r).mesh.body, static_cast<std::int32_t>(last)).normalized();
    CHECK(worn.normals.row(worn.triangles(last, 0)).cast<double>().dot(flat) > 0.999);
}

TEST_CASE("mending: a sheet is not closed by its own mirror image") {
    const shapes::Body plate = shapes::box({0, 0, 0}, {1, 1, 1}, 4, 4, 1);
    TriangleMesh sheet;
    sheet.vertices = plate.mesh.vertices;
    sheet.triangles.resize(static_cast<Eigen::Index>(plate.ends[0].triangles.size()), 3);
    for (std::size_t i = 0; i < plate.ends[0].triangles.size(); ++i)
        sheet.triangles.row(static_cast<Eigen::Index>(i)) = plate.mesh.triangles.row(plate.ends[0].triangles[i]);
    const MendResult r = mend(surface(sheet), false);
    CHECK(!only(r).closed);
    REQUIRE(find(only(r).issues, "open"));
    CHECK(find(only(r).issues, "open")->severity == Severity::Error);
    CHECK(find(r.mended, "unused-vertex")->fixed);
}

TEST_CASE("mending: copies, collapsed triangles and unused vertices go") {
    TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    const Eigen::Index n = ball.triangles.rows(), v = ball.vertices.rows();
    TriangleMesh dirty = ball;
    dirty.vertices.conservativeResize(v + 2, 3);
    dirty.vertices.bottomRows(2).setConstant(1e6);
    dirty.triangles.conservativeResize(n + 4, 3);
    dirty.triangles.row(n) = dirty.triangles.row(0);
    dirty.triangles.row(n + 1) << dirty.triangles(3, 1), dirty.triangles(3, 0), dirty.triangles(3, 2);
    dirty.triangles.row(n + 2) << 1, 1, 2;
    dirty.triangles.row(n + 3) << 5, 5, 5;
    const MendResult r = mend(surface(dirty), false);
    CHECK(only(r).closed);
    CHECK(only(r).mesh.body.vertices == ball.vertices);
    CHECK(only(r).mesh.body.triangles == ball.triangles);
    CHECK(find(r.mended, "unused-vertex")->count == 2);
    CHECK(find(r.mended, "degenerate")->count == 2);
    CHECK(find(r.mended, "duplicate-triangle")->count == 2);
}

TEST_CASE("mending: a triangle without area is flipped away where it lies in the surface") {
    // A box with a vertex put on the middle of one edge, on one side only: the other side gets a flat triangle to close the gap.
    const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh;
    const EdgeTable edges(box.triangles);
    const auto uses = edges.uses(0);
    TriangleMesh m = box;
    const Eigen::Index n = box.triangles.rows();
    const std::int32_t a = uses[0].low, b = uses[0].high, middle = static_cast<std::int32_t>(box.vertices.rows());
    m.vertices.conservativeResize(middle + 1, 3);
    m.vertices.row(middle) = (m.vertices.row(a) + m.vertices.row(b)) / 2;
    m.triangles.conservativeResize(n + 2, 3);
    const std::int32_t f = uses[0].triangle;
    const int k = uses[0].corner;
    const std::int32_t from = box.triangles(f, k), to = box.triangles(f, (k + 1) % 3), tip = box.triangles(f, (k + 2) % 3);
    m.triangles.row(f) << from, middle, tip;
    m.triangles.row(n) << middle, to, tip;
    m.triangles.row(n + 1) << from, to, middle;  // flat
    CHECK(meshFacts(m).closed);
    CHECK(find(checkMesh(m), "degenerate"));
    const MendResult r = mend(surface(m), false);
    CHECK(only(r).closed);
    CHECK(only(r).issues.empty());
    CHECK(find(r.mended, "degenerate")->count == 1);
    CHECK(meshFacts(only(r).mesh.body).volume == doctest::Approx(1.0).epsilon(1e-14));
    checkLook(only(r).mesh);
}

TEST_CASE("mending: what cannot be mended is told: pinched vertices, fins, one-sided surfaces") {
    const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1}, 1, 1, 1).mesh;
    SUBCASE("two boxes in one vertex") {
        TriangleMesh two = both(box, box);
        two.vertices.bottomRows(8).array() += 1.0;
        const auto indexOf = [&](Eigen::Index begin) {
            for (Eigen::Index v = begin; v < begin + 8; ++v)
                if (two.vertices.row(v) == Eigen::RowVector3d(1, 1, 1)) return static_cast<std::int32_t>(v);
            return -1;
        };
        const std::int32_t keep = indexOf(0), drop = indexOf(8);
        for (Eigen::Index i = 0; i < two.triangles.size(); ++i)
            if (two.triangles.data()[i] == drop) two.triangles.data()[i] = keep;
        const MendResult one = mend(surface(two), false);
        CHECK(!only(one).closed);
        REQUIRE(find(only(one).issues, "non-manifold-vertex"));
        const MendResult split = mend(surface(two), true);  // each keeps a vertex of its own
        REQUIRE(split.bodies.size() == 2);
        CHECK(split.bodies[0].closed);
        CHECK(split.bodies[1].closed);
    }
    SUBCASE("a fin") {
        TriangleMesh fin = box;
        fin.vertices.conservativeResize(9, 3);
        fin.vertices.row(8) << 3, 3, 3;
        fin.triangles.conservativeResize(13, 3);
        fin.triangles.row(12) << fin.triangles(0, 0), fin.triangles(0, 1), 8;
        const MendResult r = mend(surface(fin), false);
        CHECK(!only(r).closed);
        REQUIRE(find(only(r).issues, "non-manifold-edge"));
        CHECK(find(only(r).issues, "non-manifold-edge")->count == 1);
    }
    SUBCASE("a Moebius strip") {
        const int n = 24;
        TriangleMesh strip;
        strip.vertices.resize(2 * n, 3);
        strip.triangles.resize(2 * n, 3);
        for (int i = 0; i < n; ++i) {
            const double t = 2 * std::numbers::pi * i / n;
            for (int s = 0; s < 2; ++s) {
                const double w = s ? 0.3 : -0.3, r = 1 + w * std::cos(t / 2);
                strip.vertices.row(2 * i + s) << r * std::cos(t), r * std::sin(t), w * std::sin(t / 2);
            }
            const int j = (i + 1) % n, swap = i + 1 == n;
            strip.triangles.row(2 * i) << 2 * i, 2 * i + 1, 2 * j + swap;
            strip.triangles.row(2 * i + 1) << 2 * i + 1, 2 * j + 1 - swap, 2 * j + swap;
        }
        const MendResult r = mend(surface(strip), false);
        CHECK(!only(r).closed);
        REQUIRE(find(r.mended, "non-orientable"));
        CHECK(!find(r.mended, "non-orientable")->fixed);
    }
}

TEST_CASE("mending: any heap of triangles ends without a crash, and what is called closed is closed") {
    CHECK(rc::check([] {
        const int n = *rc::gen::inRange(3, 12);
        const auto rows = *rc::gen::container<std::vector<std::array<int, 3>>>(rc::gen::arbitrary<std::array<int, 3>>());
        RawSurface s;
        s.mesh.body.vertices.resize(n, 3);
        // Few values: many coincide.
        for (Eigen::Index i = 0; i < s.mesh.body.vertices.size(); ++i) s.mesh.body.vertices.data()[i] = *rc::gen::inRange(0, 3);
        s.mesh.body.triangles.resize(static_cast<Eigen::Index>(rows.size()), 3);
        for (std::size_t f = 0; f < rows.size(); ++f)
            for (int k = 0; k < 3; ++k) s.mesh.body.triangles(static_cast<Eigen::Index>(f), k) = static_cast<std::int32_t>(static_cast<unsigned>(rows[f][static_cast<std::size_t>(k)]) % static_cast<unsigned>(n));
        s.part.assign(rows.size(), 0);
        checkMesh(s.mesh.body);
        for (const bool split : {false, true})
            for (const MendedBody& body : mend(s, split).bodies) {
                RC_ASSERT(body.mesh.renderMesh.triangles.rows() == body.mesh.body.triangles.rows());
                if (body.closed) RC_ASSERT(meshFacts(body.mesh.body).outward);
            }
    }));
}

TEST_CASE("health: facts of known bodies") {
    const MeshFacts box = meshFacts(shapes::box({-1, 0, 2}, {1, 3, 6}, 2, 3, 4).mesh);
    CHECK(box.closed);
    CHECK(box.outward);
    CHECK(box.components == 1);
    CHECK(box.volume == doctest::Approx(24.0).epsilon(1e-14));
    CHECK(box.area == doctest::Approx(2 * (6 + 8 + 12)).epsilon(1e-14));
    CHECK(box.low == Vec3(-1, 0, 2));
    CHECK(box.high == Vec3(1, 3, 6));
    CHECK(!meshFacts(inverted(shapes::sphere(1.0, 1).mesh)).outward);
    CHECK(meshFacts(inverted(shapes::sphere(1.0, 1).mesh)).closed);
    CHECK(!meshFacts(TriangleMesh{}).closed);
    for (const double s : {1e-30, 1e30}) CHECK(meshFacts(scaled(shapes::sphere(1.0, 1).mesh, s)).outward);
}

TEST_CASE("health: broken indices and numbers are found, not followed") {
    TriangleMesh m = shapes::sphere(1.0, 1).mesh;
    m.triangles(3, 1) = 100000;
    CHECK(find(checkMesh(m), "bad-index"));
    CHECK(!meshFacts(m).closed);
    m.triangles(3, 1) = -1;
    CHECK(find(checkMesh(m), "bad-index"));
    m = shapes::sphere(1.0, 1).mesh;
    m.vertices(2, 2) = std::numeric_limits<double>::quiet_NaN();
    REQUIRE(find(checkMesh(m), "non-finite"));
    CHECK(find(checkMesh(m), "non-finite")->vertices == std::vector<std::int32_t>{2});
    CHECK(find(checkMesh(TriangleMesh{}), "empty"));
}

TEST_CASE("self-intersections: crossing bodies are found with their places, touching neighbours are not") {
    for (const double scale : {1e-8, 1.0, 1e8}) {
        const TriangleMesh ball = scaled(shapes::sphere(1.0, 2).mesh, scale);
        CHECK(selfIntersections(ball, 100).empty());
        TriangleMesh two = both(ball, ball);
        two.vertices.bottomRows(ball.vertices.rows()).col(0).array() += 1.5 * scale;
        const auto pairs = selfIntersections(two, 100000);
        CHECK(!pairs.empty());
        for (const auto& [f, g] : pairs) {
            CHECK(f < ball.triangles.rows());
            CHECK(g >= ball.triangles.rows());
        }
        CHECK(selfIntersections(two, 3).size() == 3);
    }
    // A flat surface, where exact predicates meet zeros everywhere.
    CHECK(selfIntersections(shapes::box({0, 0, 0}, {1, 1, 1}, 5, 5, 5).mesh, 100).empty());
    // A triangle folded back onto its neighbour.
    TriangleMesh fold;
    fold.vertices.resize(4, 3);
    fold.vertices << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.4, 0.7, 0;
    fold.triangles.resize(2, 3);
    fold.triangles << 0, 1, 2, 1, 0, 3;
    CHECK(selfIntersections(fold, 10).size() == 1);
    // Two triangles at one vertex, one through the other.
    TriangleMesh tip;
    tip.vertices.resize(5, 3);
    tip.vertices << 0, 0, 0, 1, -1, 0, 1, 1, 0, 1, 0, -1, 1, 0, 1;
    tip.triangles.resize(2, 3);
    tip.triangles << 0, 1, 2, 0, 3, 4;
    CHECK(selfIntersections(tip, 10).size() == 1);
}

TEST_CASE("topology: loops, components and fans") {
    const TriangleMesh ball = shapes::sphere(1.0, 1).mesh;
    const TriangleMesh open = without(ball, {0, 40});
    const EdgeTable edges(open.triangles);
    const auto loops = boundaryLoops(edges);
    REQUIRE(loops.size() == 2);
    CHECK(loops[0].size() == 3);
    // A loop runs as its cap must: the triangle that is missing.
    const auto& l = loops[0];
    bool asMissing = false;
    for (const std::int32_t f : {0, 40})
        for (int k = 0; k < 3; ++k)
            asMissing = asMissing || (ball.triangles(f, k) == l[0] && ball.triangles(f, (k + 1) % 3) == l[1] && ball.triangles(f, (k + 2) % 3) == l[2]);
    CHECK(asMissing);
    CHECK(nonManifoldVertices(open.triangles, edges).empty());
    int count = 0;
    const TriangleMesh two = both(ball, scaled(ball, 2.0));
    const auto component = edgeComponents(two.triangles, EdgeTable(two.triangles), count);
    CHECK(count == 2);
    CHECK(component.front() == 0);
    CHECK(component.back() == 1);
}

TEST_CASE("winding number: 1 inside, 0 outside, -1 inside of an inverted surface") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    std::vector<std::int32_t> all(static_cast<std::size_t>(ball.triangles.rows()));
    std::iota(all.begin(), all.end(), 0);
    CHECK(windingNumber(ball, all, {0.1, 0.2, 0.3}) == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(std::abs(windingNumber(ball, all, {1.1, 0.2, 0.3})) < 1e-12);
    CHECK(windingNumber(inverted(ball), all, {0.1, 0.2, 0.3}) == doctest::Approx(-1.0).epsilon(1e-12));
}

TEST_CASE("hole: a flat concave polygon is covered exactly, as it is wound") {
    Points star(10, 3);
    for (int i = 0; i < 10; ++i) {
        const double t = std::numbers::pi * i / 5, r = i % 2 ? 0.4 : 1.0;
        star.row(i) << r * std::cos(t), r * std::sin(t), 0.5;
    }
    const auto cap = triangulateHole(star);
    REQUIRE(cap.size() == 8);
    double area = 0.0;
    for (const auto& t : cap) {
        const Vec3 a = star.row(t[0]), b = star.row(t[1]), c = star.row(t[2]);
        const double part = (b - a).cross(c - a).z() / 2;
        CHECK(part > 0.0);
        area += part;
    }
    CHECK(area == doctest::Approx(5 * 0.4 * std::sin(std::numbers::pi / 5)).epsilon(1e-12));
}

TEST_CASE("normals: of a ball they point along its radius") {
    const TriangleMesh ball = shapes::sphere(2.0, 3).mesh;
    const Points normals = vertexNormals(ball);
    for (Eigen::Index v = 0; v < normals.rows(); ++v) CHECK(normals.row(v).dot(ball.vertices.row(v)) / 2.0 > 0.999);
}
