// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/cut.h"

#include <doctest/doctest.h>

#include <array>
#include <limits>

#include "core/mesh/cgal/intersections.h"
#include "tests/body/cut_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/voxels.h"

using namespace imomushi;
using shapes::operator+;

namespace {

using Cuts = std::vector<CutPlane>;

std::vector<BodyPiece> accepted(const TriangleMesh& body, const Cuts& cuts) {
    auto pieces = cutBody(body, cuts);
    if (!pieces) {
        FAIL_CHECK(pieces.error().code << ": " << pieces.error().message);
        return {};
    }
    checkPieces(body, cuts, *pieces);
    for (const BodyPiece& piece : *pieces) CHECK(selfIntersections(piece.body, 1).empty());
    return std::move(*pieces);
}

CutRefusal refused(const TriangleMesh& body, const Cuts& cuts) {
    auto pieces = cutBody(body, cuts);
    REQUIRE_FALSE(pieces.has_value());
    if (pieces.error().nearest) {
        Cuts moved = cuts;
        moved[static_cast<std::size_t>(pieces.error().cut)] = *pieces.error().nearest;
        const auto again = cutBody(body, moved);
        CHECK((again || (again.error().cut != pieces.error().cut && again.error().other != pieces.error().cut)));
    }
    return pieces.error();
}

double volumeOf(const BodyPiece& piece) { return enclosedVolume(piece.body.vertices, piece.body.triangles); }

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh both;
    both.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    both.vertices << a.vertices, b.vertices;
    both.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    both.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return both;
}

/// A cylinder of radius 0.5 from z = 0 to 3.
TriangleMesh limb() { return shapes::cylinder(0.5, 3.0, 24, 18).mesh; }

}  // namespace

TEST_CASE("cut: without cuts the body comes out as it is") {
    const TriangleMesh body = limb();
    const auto pieces = accepted(body, {});
    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0].body.vertices == body.vertices);
    CHECK(pieces[0].body.triangles == body.triangles);
    CHECK(pieces[0].caps.empty());
    CHECK(pieces[0].source[7] == 7);
}

TEST_CASE("cut: a limb cut across falls into two, with good caps that are joint faces") {
    const TriangleMesh body = limb();
    const Cuts cuts{{Vec3(0.1, 0.0, 1.23), Vec3(0.1, -0.2, 3.0)}};
    const auto pieces = accepted(body, cuts);
    REQUIRE(pieces.size() == 2);
    CHECK(pieces[0].caps[0].front == false);  // vertex 0 lies at z = 0
    CHECK(degrees(pieces[0].caps[0].smallestAngle) > 10.0);
    // A disc of 24 corners and triangles about as large as those around: some inside, not hundreds.
    CHECK(pieces[0].caps[0].vertices.size() > 40);
    CHECK(pieces[0].caps[0].vertices.size() < 250);
    MESSAGE("cap of " << pieces[0].caps[0].vertices.size() << " vertices, smallest angle " << degrees(pieces[0].caps[0].smallestAngle) << " degrees");
}

TEST_CASE("cut: two cuts on one limb leave three pieces, in the order of the body's vertices") {
    const TriangleMesh body = limb();
    const Cuts cuts{{Vec3(0, 0, 2.1), Vec3(0.2, 0, -1)}, {Vec3(0, 0, 0.9), Vec3(0, 0.3, 1)}};
    const auto pieces = accepted(body, cuts);
    REQUIRE(pieces.size() == 3);
    CHECK(pieces[0].caps.size() == 1);
    CHECK(pieces[0].caps[0].cut == 1);
    CHECK(pieces[1].caps.size() == 2);
    CHECK(pieces[2].caps[0].cut == 0);
    CHECK(pieces[2].caps[0].front == false);
}

TEST_CASE("cut: two cuts through the same long triangles of a box leave three pieces") {
    const TriangleMesh body = shapes::box(Vec3::Zero(), Vec3(1, 1, 4), 1, 1, 1).mesh;
    const Cuts cuts{{Vec3(0.5, 0.5, 1), Vec3(0.1, 0, 1)}, {Vec3(0.5, 0.5, 3), Vec3(0, 0.2, 1)}};
    const auto pieces = accepted(body, cuts);
    REQUIRE(pieces.size() == 3);
    // The middle has no vertex of the body and comes last.
    CHECK(std::all_of(pieces[2].source.begin(), pieces[2].source.end(), [](std::int32_t v) { return v < 0; }));
    CHECK(pieces[2].caps.size() == 2);
}

TEST_CASE("cut: a piece between two cuts has vertices that no joint face holds, also where the body has none there") {
    const TriangleMesh body = shapes::box(Vec3::Zero(), Vec3(1, 1, 4), 1, 1, 1).mesh;
    const Cuts cuts{{Vec3(0.5, 0.5, 1), Vec3(0.1, 0, 1)}, {Vec3(0.5, 0.5, 3), Vec3(0, 0.2, 1)}};
    const auto pieces = accepted(body, cuts);
    REQUIRE(pieces.size() == 3);
    for (const BodyPiece& piece : pieces) {
        std::size_t held = 0;
        for (const BodyPiece::Cap& cap : piece.caps) held += cap.vertices.size();
        CHECK(held < piece.source.size());
    }
}

TEST_CASE("cut: a cut that is moved, added or taken out leaves the bytes of all pieces but its own") {
    for (const TriangleMesh& body : {limb(), shapes::box(Vec3::Zero(), Vec3(1, 1, 3), 1, 1, 1).mesh, shapes::bar(4).mesh}) {
        Cuts cuts{{Vec3(0.2, 0.2, 0.62), Vec3(0, 0.1, 1)}, {Vec3(0.2, 0.2, 1.501), Vec3(0.1, 0, -1)}, {Vec3(0.2, 0.2, 2.31), Vec3(0, 0, 1)}};
        const auto before = accepted(body, cuts);
        REQUIRE(before.size() == 4);
        const auto find = [](const std::vector<BodyPiece>& pieces, std::vector<std::pair<int, bool>> caps) -> const BodyPiece& {
            for (const BodyPiece& piece : pieces) {
                std::vector<std::pair<int, bool>> own;
                for (const auto& cap : piece.caps) own.emplace_back(cap.cut, cap.front);
                if (own == caps) return piece;
            }
            FAIL("no such piece");
            return pieces[0];
        };
        Cuts moved = cuts;
        moved[2] = {Vec3(0.2, 0.2, 2.2), Vec3(0.2, 0.1, 1)};
        const auto after = accepted(body, moved);
        CHECK(sameBytes(find(before, {{0, false}}), find(after, {{0, false}})));
        CHECK(sameBytes(find(before, {{0, true}, {1, true}}), find(after, {{0, true}, {1, true}})));
        CHECK_FALSE(sameBytes(find(before, {{1, false}, {2, false}}), find(after, {{1, false}, {2, false}})));
        CHECK_FALSE(sameBytes(find(before, {{2, true}}), find(after, {{2, true}})));
        const auto fewer = accepted(body, {cuts[0], cuts[1]});
        CHECK(sameBytes(find(before, {{0, false}}), find(fewer, {{0, false}})));
        CHECK(sameBytes(find(before, {{0, true}, {1, true}}), find(fewer, {{0, true}, {1, true}})));
        const auto last = accepted(body, {cuts[2]});
        CHECK(sameBytes(find(before, {{2, true}}), find(last, {{0, true}})));
    }
}

TEST_CASE("cut: the same cuts give the same bytes") {
    const TriangleMesh body = shapes::sphere(1.0, 4).mesh;
    const Cuts cuts{{Vec3(0.3, 0, 0), Vec3(1, 0.3, 0.2)}, {Vec3(-0.4, 0, 0), Vec3(1, 0.1, -0.2)}};
    const auto first = accepted(body, cuts);
    std::vector<std::vector<double>> clutter;  // other addresses
    for (int i = 0; i < 100; ++i) clutter.emplace_back(static_cast<std::size_t>(1 + 37 * i));
    const auto second = accepted(body, cuts);
    REQUIRE(first.size() == second.size());
    for (std::size_t p = 0; p < first.size(); ++p) CHECK(sameBytes(first[p], second[p]));
}

TEST_CASE("cut: a plane exactly through vertices, edges and triangles of a box") {
    const TriangleMesh box = shapes::box(Vec3::Zero(), Vec3(2, 2, 2), 2, 2, 2).mesh;
    SUBCASE("along a ring of edges nothing is split") {
        const auto pieces = accepted(box, {{Vec3(1, 1, 1), Vec3(0, 0, 1)}});
        REQUIRE(pieces.size() == 2);
        CHECK(volumeOf(pieces[0]) == doctest::Approx(4.0));
        // The eight vertices of the ring are the body's; only points inside the cap may be new.
        int named = 0;
        for (const std::int32_t v : pieces[0].caps[0].vertices) named += pieces[0].source[static_cast<std::size_t>(v)] >= 0;
        CHECK(named == 8);
        const std::size_t ofBody =
            static_cast<std::size_t>(std::count_if(pieces[0].sourceTriangle.begin(), pieces[0].sourceTriangle.end(), [](std::int32_t t) { return t >= 0; }));
        CHECK(ofBody == 24);
    }
    SUBCASE("through opposite edges") {
        const auto pieces = accepted(box, {{Vec3(1, 1, 1), Vec3(1, -1, 0)}});
        REQUIRE(pieces.size() == 2);
        CHECK(volumeOf(pieces[0]) == doctest::Approx(4.0));
    }
    SUBCASE("through three corners") {
        const auto pieces = accepted(box, {{Vec3(2, 0, 0), Vec3(1, 1, 1)}});
        REQUIRE(pieces.size() == 2);
        CHECK(volumeOf(pieces[0]) == doctest::Approx(4.0 / 3.0));
    }
    SUBCASE("in a side: nothing would be cut off") {
        for (const double sign : {1.0, -1.0}) {
            const CutRefusal refusal = refused(box, {{Vec3(1, 1, 2), Vec3(0, 0, sign)}});
            CHECK(refusal.code == "no-section");
            REQUIRE(refusal.nearest.has_value());
            CHECK(refusal.nearest->origin.z() < 2.0);
            CHECK(refusal.nearest->origin.z() > 1.9);
        }
    }
}

TEST_CASE("cut: at a ledge in the plane each triangle stays with the body that it bounds") {
    // A tower on a broad base: the ledge around the tower is in the plane.
    const TriangleMesh body = shapes::surfaceOf(shapes::block({0, 0, 0}, {4, 4, 1}) + shapes::block({1, 1, 1}, {2, 3, 4}), 0.5);
    for (const double sign : {1.0, -1.0}) {
        const auto pieces = accepted(body, {{Vec3(0.75, 0.75, 0.5), Vec3(0, 0, sign)}});
        REQUIRE(pieces.size() == 2);
        CHECK(volumeOf(pieces[0]) == doctest::Approx(16 * 0.125));
        CHECK(volumeOf(pieces[1]) == doctest::Approx(6 * 0.125));
    }
}

TEST_CASE("cut: vertices near the plane slide onto it, and the volume stays") {
    TriangleMesh body = limb();
    for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) body.vertices(v, 2) += 1e-3 * std::sin(12.9 * static_cast<double>(v));  // rings are 1/6 apart
    const Cuts cuts{{Vec3(0, 0, 1.5), Vec3(0, 0, 1)}};
    const auto pieces = accepted(body, cuts);
    REQUIRE(pieces.size() == 2);
    int named = 0;
    for (const std::int32_t v : pieces[0].caps[0].vertices) named += pieces[0].source[static_cast<std::size_t>(v)] >= 0;
    CHECK(named == 24);
    CHECK(degrees(pieces[0].caps[0].smallestAngle) > 10.0);
}

TEST_CASE("cut: a ring needs two cuts, and one cut through the middle of a lying ring needs to be told which arm") {
    const TriangleMesh torus = shapes::torus(1.0, 0.3, 40, 16).mesh;
    const CutPlane right{Vec3(1, 0, 0), Vec3(0, 1, 0)}, left{Vec3(-1, 0, 0), Vec3(0, 1, 0)};
    CHECK(refused(torus, {right}).code == "does-not-separate");
    const auto pieces = accepted(torus, {right, left});
    REQUIRE(pieces.size() == 2);
    CHECK(volumeOf(pieces[0]) == doctest::Approx(volumeOf(pieces[1])));
    // Across the axis the section is an annulus.
    CHECK(accepted(torus, {{Vec3(1, 0, 0.013), Vec3(0, 0, 1)}}).size() == 2);
    // Off the hole, one section is enough.
    CHECK(accepted(torus, {{Vec3(1.1, 0, 0), Vec3(1, 0, 0)}}).size() == 2);
}

TEST_CASE("cut: only the section at the origin is cut, the rest of the plane is not") {
    // Two legs under a beam.
    const TriangleMesh body =
        shapes::surfaceOf(shapes::block({0, 0, 3}, {5, 1, 4}) + shapes::block({0, 0, 0}, {1, 1, 3}) + shapes::block({4, 0, 0}, {5, 1, 3}), 0.25);
    for (const double x : {0.1, 1.2, -7.0, 30.0}) {
        const auto pieces = accepted(body, {{Vec3(x, 0.1, 0.3), Vec3(0, 0.1, 1)}});
        REQUIRE(pieces.size() == 2);
        const std::size_t leg = volumeOf(pieces[0]) < volumeOf(pieces[1]) ? 0 : 1;
        const double middle = pieces[leg].body.vertices.col(0).mean();
        CHECK((middle < 0.6) == (x < 0.6));
    }
}

TEST_CASE("cut: a hollow body gets caps with a hole, and a cavity stays with the piece around it") {
    const TriangleMesh hollow = joined(shapes::sphere(1.0, 3).mesh, shapes::inverted(shapes::sphere(0.6, 2)).mesh);
    const auto annular = accepted(hollow, {{Vec3(0, 0, 0.1), Vec3(0.1, 0, 1)}});
    REQUIRE(annular.size() == 2);
    CHECK(meshFacts(annular[0].body).components == 1);
    const TriangleMesh body = joined(limb(), shapes::moved(shapes::inverted(shapes::sphere(0.2, 2)), Eigen::Matrix3d::Identity(), Vec3(0, 0, 2.3)).mesh);
    const auto pieces = accepted(body, {{Vec3(0, 0, 1.7), Vec3(0, 0.3, 1)}});
    REQUIRE(pieces.size() == 2);
    CHECK(meshFacts(pieces[0].body).components == 1);
    CHECK(meshFacts(pieces[1].body).components == 2);
}

TEST_CASE("cut: cuts that meet are refused with both, and the nearest place that works") {
    const TriangleMesh body = limb();
    const CutRefusal crossing = refused(body, {{Vec3(0, 0, 1.5), Vec3(0, 0, 1)}, {Vec3(0, 0, 1.6), Vec3(0, 1, 1)}});
    CHECK(crossing.code == "cuts-touch");
    CHECK(crossing.cut == 1);
    CHECK(crossing.other == 0);
    REQUIRE(crossing.nearest.has_value());
    CHECK(crossing.message.find(" m ") != std::string::npos);
    const CutRefusal same = refused(body, {{Vec3(0, 0, 1.4), Vec3(0, 0, 1)}, {Vec3(0, 0, 1.4), Vec3(0, 0, -1)}});
    CHECK(same.code == "cuts-touch");
    REQUIRE(same.nearest.has_value());
    CHECK(std::abs(same.nearest->origin.z() - 1.4) < 0.1);
    // A little apart they are fine.
    CHECK(accepted(body, {{Vec3(0, 0, 1.4), Vec3(0, 0, 1)}, {Vec3(0, 0, 1.45), Vec3(0, 0, 1)}}).size() == 3);
}

TEST_CASE("cut: the nearest place that is said works, also where other cuts meet each other") {
    // Three pairs that cross, each at its own place: only one of them can be told.
    const TriangleMesh body = shapes::cylinder(0.5, 12.0, 24, 72).mesh;
    Cuts cuts;
    for (const double z : {2.0, 6.0, 10.0})
        for (const double lean : {0.5, -0.5}) cuts.push_back({Vec3(0, 0, z), Vec3(0, lean, 1)});
    const CutRefusal crossing = refused(body, cuts);
    REQUIRE(crossing.other >= 0);
    REQUIRE(crossing.nearest.has_value());
    accepted(body, {cuts[static_cast<std::size_t>(crossing.other)], *crossing.nearest});
}

TEST_CASE("cut: a plane that misses the body says where it would hit it") {
    const CutRefusal refusal = refused(limb(), {{Vec3(0, 0, 3.5), Vec3(0, 0, 2)}});
    CHECK(refusal.code == "no-section");
    REQUIRE(refusal.nearest.has_value());
    CHECK(refusal.nearest->origin.z() < 3.0);
    CHECK(refusal.nearest->origin.z() > 2.9);
}

TEST_CASE("cut: a section that is pinched to a point is refused") {
    // Two cubes that share an edge's worth of a third one below: cut at its top, the squares meet in a corner.
    const TriangleMesh body = shapes::surfaceOf(
        shapes::block({0, 0, 0}, {2, 2, 1}) + shapes::block({0, 0, 1}, {1, 1, 3}) + shapes::block({1, 1, 1}, {2, 2, 2}) + shapes::block({0, 1, 1}, {1, 2, 2}),
        1.0);
    CHECK(accepted(body, {{Vec3(0.5, 0.5, 2.0), Vec3(0, 0, 1)}}).size() == 2);
    // A saddle exactly in the plane.
    TriangleMesh saddle = shapes::box(Vec3(-1, -1, -1), Vec3(1, 1, 1), 2, 2, 2).mesh;
    for (Eigen::Index v = 0; v < saddle.vertices.rows(); ++v)
        if (saddle.vertices(v, 2) == 1.0) saddle.vertices(v, 2) += 0.5 * (std::abs(saddle.vertices(v, 0)) - std::abs(saddle.vertices(v, 1)));
    const CutRefusal refusal = refused(saddle, {{Vec3(0.5, 0, 1), Vec3(0, 0, 1)}});
    CHECK(refusal.code == "section-touches-itself");
    CHECK(refusal.nearest.has_value());
}

TEST_CASE("cut: at any scale and far from the origin the cut is the same") {
    const Cuts cuts{{Vec3(0, 0, 1.5), Vec3(0, 0.1, 1)}, {Vec3(0, 0, 2.5), Vec3(0.1, 0, 1)}};  // the second through vertices, up to rounding
    const auto plain = accepted(limb(), cuts);
    for (const double scale : {1e-4, 1e4})
        for (const double far : {0.0, 1e3}) {
            TriangleMesh body = limb();
            const Vec3 shift = scale * far * Vec3(1, -2, 3);
            body.vertices = ((scale * body.vertices).rowwise() + shift.transpose()).eval();
            Cuts moved = cuts;
            for (CutPlane& cut : moved) cut.origin = scale * cut.origin + shift;
            const auto pieces = accepted(body, moved);
            REQUIRE(pieces.size() == plain.size());
            for (std::size_t p = 0; p < pieces.size(); ++p) {
                CHECK(volumeOf(pieces[p]) / (scale * scale * scale) == doctest::Approx(volumeOf(plain[p])).epsilon(1e-6));
            }
        }
}

TEST_CASE("cut: what is no plane and no body is refused") {
    const TriangleMesh body = limb();
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    CHECK(refused(body, {{Vec3(0, 0, 1), Vec3::Zero()}}).code == "bad-value");
    CHECK(refused(body, {{Vec3(0, nan, 1), Vec3(0, 0, 1)}}).code == "bad-value");
    CHECK(refused(body, {{Vec3(0, 0, 1), Vec3(0, infinite, 1)}}).code == "bad-value");
    CHECK(refused(body, {{Vec3(0, 0, 1e12), Vec3(0, 0, 1)}}).code == "bad-value");
    CHECK(accepted(body, {{Vec3(0, 0, 1), Vec3(0, 0, 1e200)}}).size() == 2);
    CHECK(accepted(body, {{Vec3(0, 0, 1), Vec3(0, 0, 1e-200)}}).size() == 2);
    TriangleMesh open = body;
    open.triangles.conservativeResize(body.triangles.rows() - 1, 3);
    CHECK(refused(open, {{Vec3(0, 0, 1), Vec3(0, 0, 1)}}).code == "not-closed");
    CHECK(refused(TriangleMesh{}, {}).code == "not-closed");
}

TEST_CASE("cut: the bottom of a pocket that ends at a cap, or just through it, is moved back from it") {
    for (const double beyond : {-1e-4, -1e-9, 1e-9, 1e-4}) {
        // A vertex in the middle of the low end is pulled up to the plane.
        TriangleMesh body = shapes::box(Vec3::Zero(), Vec3(1, 1, 2), 4, 4, 8).mesh;
        for (Eigen::Index v = 0; v < body.vertices.rows(); ++v)
            if (body.vertices.row(v) == Eigen::RowVector3d(0.5, 0.5, 0.0)) body.vertices(v, 2) = 1.1 + beyond;
        const Cuts cuts{{Vec3(0, 0, 1.1), Vec3(0, 0, 1)}};
        const auto pieces = cutBody(body, cuts);
        REQUIRE(pieces.has_value());
        REQUIRE(pieces->size() == 2);
        for (const BodyPiece& piece : *pieces) {
            CHECK(meshFacts(piece.body).outward);
            CHECK(selfIntersections(piece.body, 1).empty());
        }
        double tip = 0.0;
        for (Eigen::Index v = 0; v < (*pieces)[0].body.vertices.rows(); ++v)
            if ((*pieces)[0].body.vertices.row(v).head<2>() == Eigen::RowVector2d(0.5, 0.5) && (*pieces)[0].body.vertices(v, 2) != 1.1) tip = (*pieces)[0].body.vertices(v, 2);
        CHECK(tip < 1.1 - 1e-4);
        CHECK(tip > 1.09);
    }
}

TEST_CASE("cut: a sliver of rounding is no piece") {
    const CutRefusal refusal = refused(shapes::box(Vec3::Zero(), Vec3(1, 1, 1), 3, 3, 3).mesh, {{Vec3(0, 0, 1e-10), Vec3(1e-11, 0, 1)}});
    CHECK((refusal.code == "empty-piece" || refusal.code == "no-section"));
    CHECK(refusal.nearest.has_value());
}

TEST_CASE("cut: cancelled at once") {
    std::stop_source stop;
    stop.request_stop();
    const Cuts cuts{{Vec3(0, 0, 1), Vec3(0, 0, 1)}};
    const auto pieces = cutBody(limb(), cuts, Progress({}, stop.get_token()));
    REQUIRE_FALSE(pieces.has_value());
    CHECK(pieces.error().code == kCancelled);
}
