// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "core/body/body.h"
#include "core/body/flesh_links.h"
#include "core/mesh/bounds.h"
#include "tests/body/messes.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

TriangleMesh at(TriangleMesh mesh, const Vec3& place, double scale = 1.0) {
    mesh.vertices = (scale * mesh.vertices).rowwise() + place.transpose();
    return mesh;
}
TriangleMesh ball(const Vec3& place, double radius) { return at(shapes::sphere(1.0, 3).mesh, place, radius); }
TriangleMesh box(const Vec3& low, const Vec3& high) { return shapes::box(low, high, 3, 3, 3).mesh; }

struct Scene {
    TriangleMesh mesh;
    BodyBones bones;
    void add(const TriangleMesh& part, std::int32_t bone = -1) {
        const auto v = static_cast<std::int32_t>(mesh.vertices.rows());
        const Eigen::Index f = mesh.triangles.rows();
        mesh.vertices.conservativeResize(v + part.vertices.rows(), 3);
        mesh.vertices.bottomRows(part.vertices.rows()) = part.vertices;
        mesh.triangles.conservativeResize(f + part.triangles.rows(), 3);
        mesh.triangles.bottomRows(part.triangles.rows()) = (part.triangles.array() + v).matrix();
        bones.bone.resize(static_cast<std::size_t>(mesh.vertices.rows()), bone);
        volume += meshFacts(part).volume;
    }
    Body body(const BodySetting& setting = {}) const {
        auto made = makeBody(mesh, {}, setting, {}, bones.parent.empty() ? BodyBones() : bones);
        REQUIRE_MESSAGE(made.has_value(), made.error().message);
        const MeshFacts facts = meshFacts(made->mesh);
        CHECK(facts.closed);
        CHECK(facts.outward);
        for (const MeshIssue& issue : checkMesh(made->mesh)) CHECK_MESSAGE(issue.severity == Severity::Info, issue.text);
        return std::move(*made);
    }
    double volume = 0.0;
};

}  // namespace

TEST_CASE("links: two balls that do not touch are joined along the line between their middles by a tube of a part of the smaller one's radius") {
    for (const double gap : {1e-6, 0.01, 0.1}) {
        CAPTURE(gap);
        Scene scene;
        scene.add(ball({0, 0, 0}, 0.5));
        scene.add(ball({0.75 + gap, 0, 0}, 0.25));
        const Body body = scene.body();
        CHECK(body.report.components == 1);
        REQUIRE(body.report.links.size() == 1);
        const FleshLink& link = body.report.links[0];
        CHECK(link.radius > 0.4 * 0.25);
        CHECK(link.radius < 0.6 * 0.25);
        CHECK(std::abs((link.to - link.from).normalized().x()) > 0.99);
        CHECK(std::abs(link.from.y()) < 0.05);
        // What it adds is the flesh of a cylinder between two caps, which is said and is no error.
        CHECK(meshFacts(body.mesh).volume - scene.volume == doctest::Approx(link.volume).epsilon(1e-9));
        CHECK(link.volume > 0.0);
        CHECK(link.volume < std::numbers::pi * link.radius * link.radius * (gap + 0.1));
        CHECK(std::abs(body.report.volumeError) < 1e-9);
        // Vertices of the file that lie in the tube are seen no more.
        CHECK(body.report.distanceLargest * diagonalOf(body.mesh.vertices) < link.radius);
        CHECK(body.report.distanceRms < 0.01);
    }
}

TEST_CASE("links: a limb of many parts hangs together whatever their order, size and place") {
    for (const double scale : {1e-2, 1.0, 100.0}) {
        CAPTURE(scale);
        for (const bool backward : {false, true}) {
            std::vector<TriangleMesh> parts{box({-0.2, 0, -0.2}, {0.2, 0.4, 0.2}), ball({0, 0.46, 0}, 0.05), box({-0.06, 0.52, -0.06}, {0.06, 0.8, 0.06}), ball({0.001, 0.86, 0}, 0.05),
                                            box({-0.05, 0.92, -0.05}, {0.05, 1.2, 0.05})};
            if (backward) std::reverse(parts.begin(), parts.end());
            Scene scene;
            for (const TriangleMesh& part : parts) scene.add(at(part, {3.0, 1.0, -2.0}, scale));
            const Body body = scene.body();
            CHECK(body.report.components == 1);
            CHECK(body.report.links.size() == 4);
            CHECK(body.report.how == BodyKind::Mended);
        }
    }
}

TEST_CASE("links: what has a bone of its own is a limb; what its neighbour's bone moves is carried by it; what is far belongs to nothing near") {
    Scene scene;
    scene.bones.parent = {-1, 0, 0};
    scene.add(box({-0.3, 0, -0.2}, {0.3, 0.8, 0.2}), 0);     // a chest
    scene.add(box({-0.1, 0.82, -0.1}, {0.1, 1.0, 0.1}), 1);  // a head
    scene.add(shapes::box({-0.1, 0.3, 0.22}, {0.1, 0.6, 0.3}, 1, 1, 1).mesh, 0);  // a backpack, of few vertices: a body from which many are away is not the mesh
    const Body body = scene.body();
    CHECK(body.report.components == 1);
    REQUIRE(body.report.links.size() == 1);
    CHECK(body.report.links[0].from.y() == doctest::Approx(0.8).epsilon(0.02));
    CHECK(body.report.volumeError == doctest::Approx(0.2 * 0.3 * 0.08 / scene.volume).epsilon(1e-6));

    scene.bones.parent.clear();  // without a skeleton nothing says that it is no limb
    CHECK(scene.body().report.links.size() == 2);
    scene.add(box({4.0, 0, 0}, {4.1, 0.1, 0.1}));
    const Body far = scene.body();
    CHECK(far.report.links.size() == 2);
    CHECK(far.report.components == 1);
}

TEST_CASE("links: a limb that hangs on the trunk by a ball alone is no less of the body for it, whatever the order of the parts") {
    // Balls of joints are small and stand out little, but the arm touches nothing else; the second ball lies between two parts that touch anyway.
    const std::vector<TriangleMesh> parts{box({-0.4, 0, -0.3}, {0.4, 1.6, 0.3}), box({0.44, 1.2, -0.1}, {1.2, 1.4, 0.1}), box({1.19, 1.22, -0.08}, {1.9, 1.38, 0.08}), ball({0.42, 1.3, 0}, 0.08),
                                          ball({1.2, 1.3, 0}, 0.11)};
    std::vector<std::size_t> order{0, 1, 2, 3, 4};
    do {
        Scene scene;
        for (const std::size_t p : order) scene.add(parts[p]);
        const Body body = scene.body();
        CHECK(body.report.components == 1);
        CHECK(body.report.links.empty());
        CHECK(boundsOf(body.mesh.vertices).high.x() == doctest::Approx(1.9).epsilon(1e-6));
        CHECK(body.report.distanceRms < 0.01);
        CHECK(body.report.volumeError == doctest::Approx(meshFacts(parts[4]).volume / scene.volume).epsilon(0.1));
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("links: a part that nothing faces stays apart, and the body says of how many it consists") {
    Scene scene;
    scene.add(box({0, 0, 0}, {1, 1, 1}));
    scene.add(box({20, 0, 0}, {21, 1, 1}));
    const Body body = scene.body();
    CHECK(body.report.components == 2);
    CHECK(body.report.links.empty());
    CHECK(std::any_of(body.report.issues.begin(), body.report.issues.end(), [](const MeshIssue& issue) { return issue.code == "components" && issue.severity == Severity::Warning; }));
}

TEST_CASE("links: those that were asked for are made as they were asked for, others are not, and what cannot be made is said") {
    Scene scene;
    for (const double x : {0.0, 1.1, 2.2}) scene.add(box({x, 0, 0}, {x + 1.0, 1, 1}));
    const std::vector<FleshLink> found = scene.body().report.links;
    REQUIRE(found.size() == 2);

    // As they were found, they are made again.
    const Body same = scene.body({.links = found});
    REQUIRE(same.report.links.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(same.report.links[i].radius == found[i].radius);
        CHECK((same.report.links[i].from - found[i].from).norm() < 1e-6);
        CHECK(same.report.links[i].volume == doctest::Approx(found[i].volume).epsilon(1e-3));
    }

    // A thinner one elsewhere, which adds the volume of a prism of 16 sides.
    const FleshLink thin{{1.0, 0.7, 0.3}, {1.1, 0.7, 0.3}, 0.1};
    const Body one = scene.body({.links = {{thin}}});
    REQUIRE(one.report.links.size() == 1);
    CHECK((one.report.links[0].from - thin.from).norm() < 1e-6);
    CHECK(one.report.links[0].volume == doctest::Approx(0.5 * 16 * std::sin(2.0 * std::numbers::pi / 16) * 0.01 * 0.1).epsilon(1e-6));
    CHECK(one.report.components == 2);  // nothing links the third box, which is large

    const auto refused = [](const Body& body) { return std::any_of(body.report.issues.begin(), body.report.issues.end(), [](const MeshIssue& issue) { return issue.code == "link-refused"; }); };
    CHECK_FALSE(refused(one));
    // Wider than the boxes, over their rim, next to nothing; and none at all.
    for (const FleshLink& bad : {FleshLink{{1.0, 0.5, 0.5}, {1.1, 0.5, 0.5}, 0.6}, FleshLink{{1.0, 0.05, 0.5}, {1.1, 0.05, 0.5}, 0.1}, FleshLink{{1.0, 0.5, 0.5}, {1.1, 0.5, 0.5}, 1e-300}}) {
        auto made = makeBody(scene.mesh, {}, {.links = {{thin, bad}}}, {});
        REQUIRE(made);
        CHECK(made->report.links.size() == 1);
        CHECK(refused(*made));
    }
    CHECK(scene.body({.links = {{}}}).report.components == 3);
}

TEST_CASE("links: parts that lie on each other are one, however they are turned") {
    // Of a file in single precision walls that were modelled in one plane cross at the last bit.
    for (int k = 0; k < 24; ++k) {
        CAPTURE(k);
        Scene scene;
        const Vec3 axis = k % 2 == 0 ? Vec3::UnitY() : Vec3(1.0, 0.3 * k, -0.5);
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.1 + 0.25 * k, axis.normalized()).toRotationMatrix();
        for (TriangleMesh part : {box({-0.2, 0, -0.2}, {0.2, 0.4, 0.2}), box({-0.05, 0.4, -0.05}, {0.05, 0.6, 0.05})}) {
            part.vertices.col(1).array() += 1.05;
            part.vertices = (part.vertices * turn.transpose()).cast<float>().cast<double>();
            scene.add(part);
        }
        const Body body = scene.body();
        CHECK(body.report.how == BodyKind::Mended);
        CHECK(body.report.components == 1);
        CHECK(meshFacts(body.mesh).volume == doctest::Approx(scene.volume).epsilon(0.02));
        CHECK(body.report.distanceRms < 0.01);
    }
}
