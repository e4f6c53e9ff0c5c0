// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/body.h"
#include "core/body/cgal/unite.h"

#include <doctest/doctest.h>

#include <limits>
#include <numbers>
#include <stop_token>

#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "tests/body/messes.h"
#include "tests/support/shapes.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Result<Body> make(const TriangleMesh& mesh, BodyKind how = BodyKind::Auto, double detail = 0.0) { return makeBody(mesh, {}, {how, detail}, {}); }

/// What every body promises.
void checkPromise(const Body& body, const TriangleMesh& render) {
    const MeshFacts facts = meshFacts(body.mesh);
    CHECK(facts.closed);
    CHECK(facts.outward);
    CHECK(facts.components == body.report.components);
    for (const MeshIssue& issue : checkMesh(body.mesh)) CHECK(issue.severity != Severity::Error);
    REQUIRE(body.bodyVertex.size() == static_cast<std::size_t>(render.vertices.rows()));
    for (std::size_t r = 0; r < body.bodyVertex.size(); ++r) {
        CHECK(body.bodyVertex[r] < body.mesh.vertices.rows());
        if (body.bodyVertex[r] >= 0)
            CHECK((body.mesh.vertices.row(body.bodyVertex[r]) - render.vertices.row(static_cast<Eigen::Index>(r))).norm() <= 1e-6 * diagonalOf(body.mesh.vertices));
    }
}

Body made(const TriangleMesh& mesh, BodyKind expected, BodyKind how = BodyKind::Auto, double detail = 0.0) {
    auto body = make(mesh, how, detail);
    REQUIRE_MESSAGE(body.has_value(), body.error().message);
    CHECK(nameOf(body->report.how) == nameOf(expected));
    checkPromise(*body, mesh);
    return std::move(*body);
}

bool has(const Body& body, const std::string& code) {
    return std::any_of(body.report.issues.begin(), body.report.issues.end(), [&](const MeshIssue& i) { return i.code == code; });
}

double volume(const Body& body) { return meshFacts(body.mesh).volume; }

TriangleMesh boxOf(const Vec3& low, const Vec3& high, int cells) { return shapes::box(low, high, cells, cells, cells).mesh; }

/// Two arms on a beam, `gap` apart: 1 wide, 1 high, .2 deep.
TriangleMesh tongs(double gap) {
    const double inner = gap / 2;
    TriangleMesh m;
    const double x[4] = {-0.5, -inner, inner, 0.5}, y[3] = {0.0, 0.3, 1.0};
    const int outline[8][2] = {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    m.vertices.resize(16, 3);
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 2; ++k) m.vertices.row(8 * k + i) << x[outline[i][0]], y[outline[i][1]], 0.2 * k;
    const int front[6][3] = {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}};
    m.triangles.resize(28, 3);
    int f = 0;
    for (const auto& t : front) {
        m.triangles.row(f++) << t[2], t[1], t[0];
        m.triangles.row(f++) << t[0] + 8, t[1] + 8, t[2] + 8;
    }
    for (int i = 0; i < 8; ++i) {
        const int j = (i + 1) % 8;
        m.triangles.row(f++) << i, j, j + 8;
        m.triangles.row(f++) << i, j + 8, i + 8;
    }
    return m;
}

}  // namespace

TEST_CASE("body: a closed surface is its own body, bit for bit") {
    for (const TriangleMesh& mesh : {shapes::sphere(1.0, 2).mesh, shapes::torus(1.0, 0.3, 24, 12).mesh, boxOf(Vec3::Zero(), Vec3::Ones(), 3)}) {
        const Body body = made(mesh, BodyKind::Exact);
        CHECK(body.mesh.vertices == mesh.vertices);
        CHECK(body.mesh.triangles == mesh.triangles);
        for (std::size_t r = 0; r < body.bodyVertex.size(); ++r) CHECK(body.bodyVertex[r] == static_cast<std::int32_t>(r));
        CHECK(body.report.distanceLargest == 0.0);
        CHECK(body.report.volumeError == 0.0);
        CHECK(body.report.issues.empty());
    }
}

TEST_CASE("body: seams, turned, repeated and collapsed triangles leave the body exact") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    const double whole = meshFacts(ball).volume;
    CHECK(volume(made(exploded(ball, 1.0), BodyKind::Exact)) == doctest::Approx(whole));
    CHECK(volume(made(inverted(ball), BodyKind::Exact)) == doctest::Approx(whole));
    CHECK(volume(made(broken(ball, 1, 0.0, 0.1, 0.1, 0.0), BodyKind::Exact)) == doctest::Approx(whole));
    CHECK(volume(made(withTriangle(ball, 0, 0, 1), BodyKind::Exact)) == doctest::Approx(whole));
    TriangleMesh unused = ball;
    unused.vertices.conservativeResize(unused.vertices.rows() + 1, 3);
    unused.vertices.bottomRows(1) << kNan, 1e300, -1e300;
    auto body = make(unused);
    REQUIRE(body.has_value());
    CHECK(body->report.how == BodyKind::Exact);
    CHECK(body->bodyVertex.back() == -1);
}

TEST_CASE("body: holes are closed") {
    const TriangleMesh box = boxOf(Vec3::Zero(), Vec3::Ones(), 2);
    const Body body = made(without(box, {0, 1, 2}), BodyKind::Mended);
    CHECK(volume(body) == doctest::Approx(1.0));
    CHECK(has(body, "open"));
    CHECK(body.report.volumeError < 0.0);  // an open mesh encloses nothing that could be compared
    CHECK(made(without(box, {0, 1, 2}), BodyKind::Wrapped, BodyKind::Wrapped, 0.05).report.volumeError < 0.0);
}

TEST_CASE("body: parts that no link joins become one by a wrap") {
    // Edge beside edge: no tube fits between them.
    const Body body = made(both(boxOf(Vec3::Zero(), Vec3::Ones(), 1), boxOf(Vec3(1.0, 1.001, 0.2), Vec3(2.0, 2.0, 1.5), 1)), BodyKind::Wrapped);
    CHECK(body.report.components == 1);
    CHECK(has(body, "wrapped"));
    CHECK_FALSE(has(body, "components"));
}

TEST_CASE("body: parts that overlap become one") {
    const TriangleMesh a = boxOf(Vec3::Zero(), Vec3::Ones(), 2), b = moved(a, 1.0, Vec3(0.5, 0.31, 0.27));
    const Body two = made(both(a, b), BodyKind::Mended);
    CHECK(volume(two) == doctest::Approx(2.0 - 0.5 * 0.69 * 0.73));
    CHECK(two.report.components == 1);
    CHECK(has(two, "united"));
    // A chain of which neighbours alone overlap, given in another order.
    const Body chain = made(both(both(a, moved(a, 1.0, Vec3(1.8, 0.02, 0.01))), moved(a, 1.0, Vec3(0.9, 0.01, 0.02))), BodyKind::Mended);
    CHECK(chain.report.components == 1);
    CHECK(volume(chain) == doctest::Approx(3.0 - 0.1 * 0.99 * 0.98 - 0.1 * 0.99 * 0.99));
}

TEST_CASE("body: walls of parts that were modelled in one place and differ by rounding leave no slivers") {
    const TriangleMesh a = boxOf(Vec3::Zero(), Vec3::Ones(), 1);
    const double off = 4e-7;  // beyond what counts as no area, far below what is modelled
    const Body body = made(both(a, boxOf(Vec3(0.5, -off, -off), Vec3(1.5, 1.0 + off, 1.0 + off), 1)), BodyKind::Mended);
    CHECK(has(body, "united"));
    CHECK(volume(body) == doctest::Approx(1.5).epsilon(1e-5));
    double flattest = 1.0;
    for (std::int32_t f = 0; f < body.mesh.triangles.rows(); ++f) {
        double longest = 0.0;
        for (int k = 0; k < 3; ++k) longest = std::max(longest, (body.mesh.vertices.row(body.mesh.triangles(f, k)) - body.mesh.vertices.row(body.mesh.triangles(f, (k + 1) % 3))).norm());
        flattest = std::min(flattest, areaVector(body.mesh, f).norm() / (longest * longest));
    }
    CHECK(flattest > 1e-3);
}

TEST_CASE("body: one surface whose flesh overlaps itself gives a body that does not cross itself") {
    // A curl of one tube: it passes through itself at full thickness, as an arm that was modelled into the hip. Small crossings alone can be untangled.
    constexpr int kAround = 12, kAlong = 60;
    TriangleMesh curl;
    curl.vertices.resize(kAround * (kAlong + 1) + 2, 3);
    std::vector<Vec3> path;
    for (int i = 0; i <= kAlong; ++i) {
        const double t = -2.2 + 4.4 * i / kAlong;  // a loop in the plane of x and y that closes over its own beginning
        path.emplace_back(t * t * t - 2.0 * t, t * t, 0.05 * t);
    }
    for (int i = 0; i <= kAlong; ++i) {
        const Vec3 along = (path[static_cast<std::size_t>(std::min(i + 1, kAlong))] - path[static_cast<std::size_t>(std::max(i - 1, 0))]).normalized();
        const Vec3 side = along.cross(Vec3::UnitZ()).normalized(), up = side.cross(along);
        for (int k = 0; k < kAround; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / kAround;
            curl.vertices.row(i * kAround + k) = (path[static_cast<std::size_t>(i)] + 0.35 * (std::cos(angle) * side + std::sin(angle) * up)).transpose();
        }
    }
    const int first = kAround * (kAlong + 1), last = first + 1;
    curl.vertices.row(first) = path.front().transpose();
    curl.vertices.row(last) = path.back().transpose();
    curl.triangles.resize(2 * kAround * (kAlong + 1), 3);
    Eigen::Index f = 0;
    for (int k = 0; k < kAround; ++k) {
        const int j = (k + 1) % kAround;
        curl.triangles.row(f++) << first, j, k;
        for (int i = 0; i < kAlong; ++i) {
            curl.triangles.row(f++) << i * kAround + k, i * kAround + j, (i + 1) * kAround + j;
            curl.triangles.row(f++) << i * kAround + k, (i + 1) * kAround + j, (i + 1) * kAround + k;
        }
        curl.triangles.row(f++) << last, kAlong * kAround + k, kAlong * kAround + j;
    }
    if (meshFacts(curl).volume < 0.0) curl.triangles.col(1).swap(curl.triangles.col(2));
    const Body body = made(curl, BodyKind::Mended);
    CHECK_FALSE(has(body, "self-intersection"));
    CHECK(has(body, "untangled"));
    CHECK(body.report.components == 1);
    CHECK(body.report.distanceRms < 1e-3);  // most of its vertices are those of the file; what is buried is not seen
    CHECK(volume(body) < meshFacts(curl).volume);
    CHECK(volume(body) > 0.9 * meshFacts(curl).volume);
}

TEST_CASE("body: fans of hundreds of triangles that cross are untangled within seconds") {
    // A low drum; the middle of its lid pierces the bottom. What takes the number of triangles at a vertex to the power of four, as CGAL's normals do, does not end here.
    constexpr int kAround = 600;
    TriangleMesh drum;
    drum.vertices.resize(2 * kAround + 2, 3);
    drum.triangles.resize(4 * kAround, 3);
    for (int i = 0; i < kAround; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kAround;
        for (int end = 0; end < 2; ++end) drum.vertices.row(end * kAround + i) << 0.5 * std::cos(angle), 0.3 * end, 0.5 * std::sin(angle);
        const int j = (i + 1) % kAround;
        drum.triangles.row(4 * i) << i, kAround + i, kAround + j;
        drum.triangles.row(4 * i + 1) << i, kAround + j, j;
        drum.triangles.row(4 * i + 2) << 2 * kAround, i, j;
        drum.triangles.row(4 * i + 3) << 2 * kAround + 1, kAround + j, kAround + i;
    }
    drum.vertices.row(2 * kAround) << 0.0, 0.0, 0.0;
    drum.vertices.row(2 * kAround + 1) << 0.0, -0.01, 0.0;
    const Body body = made(drum, BodyKind::Mended);
    CHECK(has(body, "untangled"));
    CHECK_FALSE(has(body, "self-intersection"));
    CHECK(body.report.distanceRms < 1e-3);
}

TEST_CASE("body: a surface that touches itself, or crosses itself by no more than rounding, gets a little room there") {
    for (const double beyond : {-1e-9, -1e-12, 1e-12}) {
        // A pocket from the low end reaches the middle of a triangle of the high end.
        TriangleMesh box = shapes::box(Vec3::Zero(), Vec3(1, 1, 2), 4, 4, 8).mesh;
        for (Eigen::Index v = 0; v < box.vertices.rows(); ++v)
            if (box.vertices.row(v) == Eigen::RowVector3d(0.5, 0.5, 0.0)) box.vertices.row(v) << 0.56, 0.61, 2.0 + beyond;
        const Body body = made(box, BodyKind::Mended);
        CHECK(has(body, "parted"));
        CHECK_FALSE(has(body, "self-intersection"));
        CHECK_FALSE(has(body, "untangled"));
        // One vertex has moved, by a thousandth of its shortest edge: the pocket's own, downwards.
        int moved = 0;
        for (std::size_t v = 0; v < body.bodyVertex.size(); ++v) {
            if (body.bodyVertex[v] >= 0) continue;
            ++moved;
            const Vec3 now = body.mesh.vertices.row(static_cast<Eigen::Index>(v)).transpose();
            CHECK((now - Vec3(0.56, 0.61, 2.0)).norm() < 0.005);
            CHECK(now.z() < 2.0 - 1e-4);
        }
        CHECK(moved == 1);
    }
}

TEST_CASE("body: a part inside is left out, a cavity stays") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh, core = moved(ball, 0.5, Vec3::Zero());
    const double whole = meshFacts(ball).volume;
    const Body filled = made(both(ball, core), BodyKind::Mended);
    CHECK(volume(filled) == doctest::Approx(whole));
    CHECK(has(filled, "inside"));
    CHECK(volume(made(both(ball, inverted(core)), BodyKind::Exact)) == doctest::Approx(whole * 7.0 / 8.0));
    CHECK(volume(made(inverted(both(ball, inverted(core))), BodyKind::Exact)) == doctest::Approx(whole * 7.0 / 8.0));
}

TEST_CASE("body: eyes and buttons follow the body") {
    const TriangleMesh ball = shapes::sphere(1.0, 3).mesh;
    TriangleMesh eyes = ball;
    for (const double x : {-0.3, 0.3}) eyes = both(eyes, moved(shapes::sphere(1.0, 2).mesh, 0.08, Vec3(x, 0.3, 0.9)));
    const Body body = made(eyes, BodyKind::Mended);
    CHECK(has(body, "attached"));
    CHECK(body.mesh.vertices == ball.vertices);
    CHECK(body.bodyVertex.back() == -1);
    CHECK(body.report.distanceLargest < 0.03);
    // An arm is no button.
    const Body arm = made(both(ball, moved(shapes::box(Vec3(0.8, -0.05, -0.05), Vec3(2.0, 0.05, 0.05), 6, 1, 1).mesh, 1.0, Vec3::Zero())), BodyKind::Mended);
    CHECK(arm.mesh.vertices.col(0).maxCoeff() == 2.0);
}

TEST_CASE("body: walls and fins where more than two triangles meet are left out") {
    // Two cubes that share a face, welded: the wall between them has edges with three triangles.
    const TriangleMesh a = boxOf(Vec3::Zero(), Vec3::Ones(), 1), b = moved(a, 1.0, Vec3(1.0, 0.0, 0.0));
    TriangleMesh cubes = both(a, b);
    for (Eigen::Index i = 0; i < cubes.triangles.size(); ++i) {
        std::int32_t& v = cubes.triangles.data()[i];
        for (std::int32_t w = 0; w < v; ++w)
            if (cubes.vertices.row(w) == cubes.vertices.row(v)) v = w;
    }
    const Body walled = made(cubes, BodyKind::Mended);
    CHECK(volume(walled) == doctest::Approx(2.0));
    CHECK(walled.report.components == 1);
    CHECK(has(walled, "inner-wall"));
    TriangleMesh fin = shapes::sphere(1.0, 2).mesh;
    fin.vertices.conservativeResize(fin.vertices.rows() + 1, 3);
    fin.vertices.bottomRows(1) << 0.0, 1.5, 1.0;
    fin = withTriangle(fin, fin.triangles(0, 0), fin.triangles(0, 1), static_cast<int>(fin.vertices.rows()) - 1);
    const Body finned = made(fin, BodyKind::Mended);
    CHECK(finned.mesh.triangles.rows() == fin.triangles.rows() - 1);
}

TEST_CASE("body: a wing that hangs on an edge of the body is no wall inside of it") {
    TriangleMesh bird = both(boxOf(Vec3::Zero(), Vec3::Ones(), 1), moved(boxOf(Vec3::Zero(), Vec3(0.5, 0.5, 1.0), 1), 1.0, Vec3(1.0, 1.0, 0.0)));
    for (Eigen::Index i = 0; i < bird.triangles.size(); ++i) {
        std::int32_t& v = bird.triangles.data()[i];
        for (std::int32_t w = 0; w < v; ++w)
            if (bird.vertices.row(w) == bird.vertices.row(v)) v = w;
    }
    const Body body = made(bird, BodyKind::Mended);
    CHECK_FALSE(has(body, "inner-wall"));
    CHECK(volume(body) == doctest::Approx(1.25).epsilon(1e-3));
    CHECK(body.report.components == 1);
    CHECK(body.report.distanceLargest < 1e-3);
}

TEST_CASE("body: what lies in the flesh of the mesh itself, where nobody sees it, is no distance of a wrap") {
    // An eye half in a ball of loose triangles.
    const TriangleMesh head = exploded(shapes::sphere(1.0, 3).mesh, 0.9), eye = moved(shapes::sphere(1.0, 3).mesh, 0.5, Vec3(0.0, 0.0, 1.0));
    const Body body = made(both(head, eye), BodyKind::Wrapped);
    CHECK(volume(body) > 4.2);
    CHECK(body.report.distanceLargest < 0.02);  // the back of the eye is .2 of the size inside
}

TEST_CASE("body: loose triangles are wrapped, and the ball does not fall through the slits") {
    const TriangleMesh ball = shapes::sphere(1.0, 3).mesh;
    const Body body = made(exploded(ball, 0.9), BodyKind::Wrapped);
    CHECK(volume(body) == doctest::Approx(meshFacts(ball).volume).epsilon(0.03));
    CHECK(body.report.distanceLargest < 0.01);
    CHECK(body.report.components == 1);
}

TEST_CASE("body: a wrap keeps gaps open that it can, and tells of those it closed") {
    const TriangleMesh mesh = tongs(0.03);
    REQUIRE(meshFacts(mesh).outward);
    const double diagonal = diagonalOf(mesh.vertices), gap = 0.03 / diagonal;
    const Body fine = made(mesh, BodyKind::Wrapped, BodyKind::Wrapped);
    CHECK(fine.report.gaps.area < 5e-4);  // three of all samples: corners of large triangles look like gaps
    CHECK(fine.report.detail < 0.5 * gap);
    CHECK(fine.report.volumeError < 1e-3);
    CHECK(fine.report.distanceRms < 2e-3);

    const Body coarse = made(mesh, BodyKind::Wrapped, BodyKind::Wrapped, 0.03);
    CHECK(coarse.report.detail == 0.03);
    CHECK(coarse.report.gaps.area > 0.05);  // two walls of .7 x .2 m of 3.3 m^2 are .085 of it
    CHECK(coarse.report.gaps.narrowest > 0.9 * gap);
    CHECK(has(coarse, "closed-gap"));
    REQUIRE(!coarse.report.gaps.places.empty());
    const Vec3 place = coarse.report.gaps.places.front();
    CHECK(std::abs(place.x()) < 0.015);
    CHECK(place.y() > 0.3);
}

TEST_CASE("body: only what was asked for is made") {
    const TriangleMesh ball = shapes::sphere(1.0, 2).mesh;
    CHECK(make(without(ball, {3}), BodyKind::Exact).error().code == "not-exact");
    CHECK(make(exploded(ball, 0.9), BodyKind::Mended).error().code == "not-mendable");
    CHECK(made(without(ball, {3}), BodyKind::Mended, BodyKind::Mended).report.how == BodyKind::Mended);
    CHECK(made(ball, BodyKind::Wrapped, BodyKind::Wrapped, 0.05).report.volumeError < 0.01);
}

TEST_CASE("body: what cannot be a body is refused with the reason") {
    const TriangleMesh ball = shapes::sphere(1.0, 1).mesh;
    CHECK(make(TriangleMesh{}).error().code == "empty-mesh");
    TriangleMesh bad = ball;
    bad.triangles(0, 0) = 1000;
    CHECK(make(bad).error().code == "bad-index");
    bad = ball;
    bad.vertices(3, 1) = kNan;
    CHECK(make(bad).error().code == "non-finite");
    bad.vertices(3, 1) = 1e200;
    CHECK(make(bad).error().code == "non-finite");
    TriangleMesh point = ball;
    point.vertices.setOnes();
    CHECK(make(point).error().code == "no-volume");
    for (const double detail : {kNan, -1.0, 1e-5, 0.5}) CHECK(make(ball, BodyKind::Wrapped, detail).error().code == "bad-detail");
    const std::vector<std::int32_t> part(3, 0);
    CHECK(makeBody(ball, part, {}, {}).error().code == "bad-index");
}

TEST_CASE("body: a cancelled one ends") {
    std::stop_source stop;
    stop.request_stop();
    const Progress progress({}, stop.get_token());
    CHECK(makeBody(exploded(shapes::sphere(1.0, 3).mesh, 0.9), {}, {}, progress).error().code == kCancelled);
}

TEST_CASE("body: far, tiny and huge meshes get the same body") {
    const TriangleMesh mesh = tongs(0.1);
    const Body body = made(mesh, BodyKind::Wrapped, BodyKind::Wrapped, 0.04);
    for (const double scale : {1e-8, 1e8}) {
        const Body scaled = made(moved(mesh, scale, Vec3(3.0, -2.0, 1.0) * scale), BodyKind::Wrapped, BodyKind::Wrapped, 0.04);
        CHECK(volume(scaled) / (scale * scale * scale) == doctest::Approx(volume(body)).epsilon(1e-3));
    }
}

TEST_CASE("body: the same mesh gives the same bytes") {
    const TriangleMesh mesh = exploded(shapes::torus(1.0, 0.3, 16, 8).mesh, 0.9);
    const Body a = made(mesh, BodyKind::Wrapped), b = made(mesh, BodyKind::Wrapped);
    CHECK(a.mesh.vertices == b.mesh.vertices);
    CHECK(a.mesh.triangles == b.mesh.triangles);
}

TEST_CASE("body: whatever is broken, there is a sound body or a reason") {
    const std::vector<TriangleMesh> clean{shapes::sphere(1.0, 2).mesh, shapes::torus(1.0, 0.3, 16, 8).mesh, boxOf(Vec3::Zero(), Vec3::Ones(), 2),
                                          both(shapes::sphere(1.0, 1).mesh, moved(shapes::sphere(1.0, 1).mesh, 0.7, Vec3(0.9, 0.1, 0.2)))};
    int bodies = 0, tries = 0;
    for (unsigned seed = 0; seed < 15; ++seed)
        for (const TriangleMesh& mesh : clean) {
            const double much = 0.04 * static_cast<double>(seed);
            const TriangleMesh mess = broken(mesh, seed, seed % 2 ? much : 0.0, seed % 3 ? much : 0.0, 0.1, seed % 5 == 4 ? 0.3 * much : 0.0);
            CAPTURE(seed);
            CAPTURE(mesh.vertices.rows());
            const auto body = make(mess, BodyKind::Auto, 0.05);
            ++tries;
            if (!body) {
                CHECK(body.error().code == "no-volume");
                continue;
            }
            checkPromise(*body, mess);
            ++bodies;
        }
    CHECK(bodies > 0.9 * tries);
}

TEST_CASE("body: whether two surfaces meet is told of surfaces with triangles without area too") {
    // A tetrahedron whose edge from the first to the second vertex has its middle on one side only.
    TriangleMesh split;
    split.vertices.resize(5, 3);
    split.vertices << 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, -2, 1, 0, 0;
    split.triangles.resize(6, 3);
    split.triangles << 0, 1, 2, 1, 0, 4, 4, 0, 3, 1, 4, 3, 2, 1, 3, 0, 2, 3;
    const auto shifted = [&](double by) {
        TriangleMesh mesh = split;
        mesh.vertices.col(0).array() += by;
        return mesh;
    };
    CHECK(surfacesMeet(split, shifted(0.5)));
    CHECK(!surfacesMeet(split, shifted(5.0)));
}
