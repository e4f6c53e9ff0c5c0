// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/scene/document_scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "tests/document/workbench.h"
#include "ui/scene/framing.h"

using namespace imomushi;
using render::Marker;

namespace {

int count(const render::Scene& scene, Marker::Shape shape) {
    return static_cast<int>(std::count_if(scene.markers.begin(), scene.markers.end(), [&](const Marker& m) { return m.shape == shape; }));
}

const Marker* markerWith(const render::Scene& scene, std::uint64_t id) {
    const auto at = std::find_if(scene.markers.begin(), scene.markers.end(), [&](const Marker& m) { return m.id == id; });
    return at == scene.markers.end() ? nullptr : &*at;
}

}  // namespace

TEST_CASE("scene ids lead back to their parts, and no two parts share one") {
    std::set<std::uint64_t> ids;
    for (const PartId part : {PartId(1), PartId(2), PartId(70'000), PartId(1) << 40})
        for (const auto& p : {ScenePart{ScenePart::Kind::Element, part, -1, false}, ScenePart{ScenePart::Kind::Bone, part, -1, false},
                              ScenePart{ScenePart::Kind::Face, part, 0, false}, ScenePart{ScenePart::Kind::Face, part, 300, false},
                              ScenePart{ScenePart::Kind::Endpoint, part, -1, false}, ScenePart{ScenePart::Kind::Endpoint, part, -1, true}}) {
            CHECK(ids.insert(sceneId(p)).second);
            CHECK(scenePart(sceneId(p)) == p);
        }
    for (const std::uint64_t id : {std::uint64_t(0), std::uint64_t(5), ~std::uint64_t(0)}) CHECK(!scenePart(id));
}

TEST_CASE("an empty document is an empty scene, framed as a cube on the ground") {
    Workbench bench;
    DocumentScene view;
    render::Scene scene;
    view.update(bench.session, {}, scene);
    CHECK(scene.bodies.empty());
    CHECK(scene.markers.empty());
    CHECK(scene.ground == 0.0);
    const render::Camera camera = framed(scene, threeQuarterDirection(), 1.5);
    CHECK(camera.eye.allFinite());
    CHECK((camera.eye - camera.target).norm() > 1.0);
    CHECK((camera.eye - camera.target).norm() < 10.0);
}

TEST_CASE("joined faces are covered and welded; free ones stay drawn; hiding a neighbour uncovers them") {
    Workbench bench;
    bench.buildChain();
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.faces = true;
    view.update(bench.session, options, scene);
    REQUIRE(scene.bodies.size() == 2);
    const Document& document = bench.session.document();
    const Element *a = document.elementNamed("A"), *b = document.elementNamed("B");
    REQUIRE(scene.bodies[0].coveredTriangles);
    CHECK(*scene.bodies[0].coveredTriangles == a->faces[a->faceIndex("out")].triangles);
    CHECK(*scene.bodies[1].coveredTriangles == b->faces[b->faceIndex("in")].triangles);
    REQUIRE(scene.seams.size() == 1);
    CHECK(scene.seams[0].welded->size() == a->faces[a->faceIndex("out")].vertices.size());
    for (const auto& [va, vb] : *scene.seams[0].welded)
        CHECK((a->mesh->body.vertices.row(va) - b->mesh->body.vertices.row(vb)).norm() < 1e-9);
    // Three outlines for four faces: the joined two lie on each other. Each is a square of 4 x 2 cells.
    CHECK(count(scene, Marker::Shape::FaceOutline) == 3);
    for (const Marker& m : scene.markers) CHECK(m.outline.size() == 8);

    // What does not change keeps its identity, so nothing is uploaded again.
    const auto covered = scene.bodies[0].coveredTriangles;
    const auto welded = scene.seams[0].welded;
    const auto revision = scene.bodies[0].revision;
    view.update(bench.session, options, scene);
    CHECK(scene.bodies[0].coveredTriangles == covered);
    CHECK(scene.seams[0].welded == welded);
    CHECK(scene.bodies[0].revision == revision);

    bench.good({{"do", "set"}, {"target", "B"}, {"property", "visible"}, {"value", false}});
    view.update(bench.session, options, scene);
    REQUIRE(scene.bodies.size() == 1);
    CHECK(!scene.bodies[0].coveredTriangles);
    CHECK(scene.seams.empty());
}

TEST_CASE("bones show as bones, ends that are one joint point as one point, held and pinned ends by their shape") {
    Workbench bench;
    bench.buildChain();
    bench.good({{"do", "pin"}, {"endpoint", "a/start"}});
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.bones = true;
    view.update(bench.session, options, scene);
    const Document& document = bench.session.document();
    const PartId a = document.boneNamed("a")->id, b = document.boneNamed("b")->id;
    CHECK(count(scene, Marker::Shape::Bone) == 2);
    CHECK(count(scene, Marker::Shape::PinnedPoint) == 1);
    CHECK(count(scene, Marker::Shape::JointPoint) == 2);
    const Marker* bone = markerWith(scene, sceneId({ScenePart::Kind::Bone, b, -1, false}));
    REQUIRE(bone);
    CHECK((bone->from - Vec3(0, 0, 3)).norm() < 1e-6);
    CHECK((bone->to - Vec3(0, 0, 6)).norm() < 1e-6);
    // The point between the bones answers for the end of the first.
    CHECK(markerWith(scene, sceneId({ScenePart::Kind::Endpoint, a, -1, true})));
    CHECK(!markerWith(scene, sceneId({ScenePart::Kind::Endpoint, b, -1, false})));

    const auto before = scene.bodies[1].revision;
    bench.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.0, 5.0}}});
    options.selected = {sceneId({ScenePart::Kind::Endpoint, b, -1, true}), scene.bodies[1].id};
    options.hovered = sceneId({ScenePart::Kind::Bone, a, -1, false});
    view.update(bench.session, options, scene);
    const Marker* end = markerWith(scene, sceneId({ScenePart::Kind::Endpoint, b, -1, true}));
    REQUIRE(end);
    CHECK(end->shape == Marker::Shape::HeldPoint);
    CHECK(end->selected);
    CHECK((end->from - Vec3(1.5, 0, 5)).norm() < 0.05);
    CHECK(markerWith(scene, options.hovered)->hovered);
    CHECK(scene.bodies[1].selected);
    CHECK(!scene.bodies[0].selected);
    CHECK(scene.bodies[1].revision != before);
}

TEST_CASE("locked elements are not picked, hidden ones not drawn, and the ground lies under what is below zero") {
    Workbench bench;
    bench.good({{"do", "import-element"}, {"path", "bar0"}, {"name", "A"}});
    bench.good({{"do", "set"}, {"target", "A"}, {"property", "locked"}, {"value", true}});
    DocumentScene view;
    render::Scene scene;
    view.update(bench.session, {}, scene);
    REQUIRE(scene.bodies.size() == 1);
    CHECK(!scene.bodies[0].pickable);
    CHECK(scene.ground == doctest::Approx(bench.session.document().elementNamed("A")->mesh->body.vertices.col(1).minCoeff()));
    CHECK(scene.ground <= 0.0);
    bench.good({{"do", "set"}, {"target", "A"}, {"property", "visible"}, {"value", false}});
    view.update(bench.session, {}, scene);
    CHECK(scene.bodies.empty());
}

TEST_CASE("hidden bones and joint faces are not drawn; an end is as long as a bone that is seen has it") {
    Workbench bench;
    bench.buildChain();
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.bones = options.faces = true;
    bench.good({{"do", "set"}, {"target", "b"}, {"property", "visible"}, {"value", false}});
    view.update(bench.session, options, scene);
    CHECK(count(scene, Marker::Shape::Bone) == 1);
    CHECK(count(scene, Marker::Shape::JointPoint) == 2);
    REQUIRE(count(scene, Marker::Shape::FaceOutline) == 3);
    bench.good({{"do", "set"}, {"target", "B/out"}, {"property", "visible"}, {"value", false}});
    view.update(bench.session, options, scene);
    CHECK(count(scene, Marker::Shape::FaceOutline) == 2);
}

TEST_CASE("a joint face that is selected shows its frame where it is: its third axis points out of the element, and turns with it") {
    Workbench bench;
    bench.buildChain();
    bench.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.4, 0.3, 5.5}}});
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.faces = true;
    const Element& element = *bench.session.document().elementNamed("B");
    const int face = element.faceIndex("out");
    const std::vector<std::uint64_t> selected{sceneId({ScenePart::Kind::Face, element.id, face, false})};
    view.update(bench.session, options, scene);
    CHECK(count(scene, Marker::Shape::Axis) == 0);
    options.selected = selected;
    view.update(bench.session, options, scene);
    REQUIRE(count(scene, Marker::Shape::Axis) == 3);
    std::vector<Vec3> axes;
    Vec3 at = Vec3::Zero();
    for (const Marker& marker : scene.markers)
        if (marker.shape == Marker::Shape::Axis) axes.push_back((marker.to - marker.from).normalized()), at = marker.from;
    const JointFace& of = element.faces[static_cast<std::size_t>(face)];
    const auto end = bench.session.positionOf({bench.session.document().boneNamed("b")->id, true});
    REQUIRE(end.has_value());
    CHECK((at - *end).norm() < 1e-4);  // the bone ends in the middle of the face
    CHECK((*end - of.frame.origin).norm() > 0.1);  // it was moved
    CHECK((axes[0].cross(axes[1]) - axes[2]).norm() < 1e-6);
    CHECK(axes[2].dot(of.frame.axes.col(2)) > 0.7);
    CHECK(axes[2].dot(of.frame.axes.col(2)) < 0.9999);
}

TEST_CASE("a framed body fills the picture and stays inside it, from every side and in every format") {
    Workbench bench;
    bench.buildChain();
    DocumentScene view;
    render::Scene scene;
    view.update(bench.session, {}, scene);
    for (const Vec3& direction : {threeQuarterDirection(), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(-1, 2, 3)})
        for (const double aspect : {0.4, 1.0, 2.5})
            for (const bool flat : {false, true}) {
                scene.camera.orthographic = flat;
                const render::Camera camera = framed(scene, direction, aspect);
                const Eigen::Matrix4d m = camera.projection(aspect, camera.target, 20.0) * camera.view();
                double widest = 0.0, highest = 0.0;
                for (const render::Body& body : scene.bodies)
                    for (Eigen::Index v = 0; v < body.mesh->body.vertices.rows(); ++v) {
                        const Vec3 p = body.mesh->body.vertices.row(v).transpose();
                        const Eigen::Vector4d c = m * p.homogeneous();
                        REQUIRE(c.w() > 0.0);
                        widest = std::max(widest, std::abs(c.x() / c.w()));
                        highest = std::max(highest, std::abs(c.y() / c.w()));
                    }
                CHECK(widest < 1.0);
                CHECK(highest < 1.0);
                CHECK(std::max(widest, highest) > 0.6);
                CHECK((camera.target - camera.eye).normalized().dot(direction.normalized()) > 0.999);
            }
}

TEST_CASE("two views of one character that is performed: each frame is deformed once, whoever looks") {
    std::atomic<int> steps{0};
    Workbench bench;
    bench.buildChain();
    bench.good({{"do", "precompute"}});
    bench.good({{"do", "enable"}, {"effect", "bone-dynamics"}});
    bench.session.perform([&] { ++steps; });
    bench.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 0.5, 3.0}}});
    DocumentScene one, two;
    render::Scene first, second;
    const auto revision = [&] { return bench.session.character()->surface(0).revision; };
    one.update(bench.session, {}, first);
    std::uint64_t before = revision();
    int frames = 0;
    for (const auto start = std::chrono::steady_clock::now(); frames < 20 && std::chrono::steady_clock::now() - start < std::chrono::seconds(60);) {
        if (!bench.session.takeFrame()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            continue;
        }
        if (!bench.session.moving()) break;  // its last frame is shown by the live character
        ++frames;
        one.update(bench.session, {}, first);
        two.update(bench.session, {}, second);
        CHECK(first.bodies[0].positions == second.bodies[0].positions);
        CHECK(first.bodies[0].revision == second.bodies[0].revision);
        CHECK(revision() == before + 1);
        before = revision();
    }
    CHECK(frames == 20);
    MESSAGE(frames << " frames of " << steps.load() << " steps were shown by two views, each deformed once");
}
