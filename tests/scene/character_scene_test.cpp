// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "tests/document/workbench.h"
#include "ui/scene/cut_frame.h"
#include "ui/scene/document_scene.h"

using namespace imomushi;

namespace {

constexpr double kFloat = 5e-5;  // m: fifty units in the last place of 12 m in single precision

/// The trunk of 12 m along z as "low" and "high", cut at z = 5.1, with a bone through each.
void buildCutTrunk(Workbench& w) {
    w.good({{"do", "import-character"}, {"path", "trunk"}, {"name", "worm"}});
    w.good({{"do", "rename"}, {"target", "worm body"}, {"name", "low"}});
    w.addFace("low", "in", 0, -1);
    w.addFace("low", "out", 12, 1);
    w.good({{"do", "cut"}, {"element", "low"}, {"plane", {{"origin", {0, 0, 5.1}}, {"normal", {0, 0, 1}}}}, {"names", {"low", "high"}}, {"name", "waist"}});
    w.good({{"do", "add-bone"}, {"name", "a"}, {"from", "low/in"}, {"to", "low/waist"}});
    w.good({{"do", "add-bone"}, {"name", "b"}, {"from", "a/end"}, {"to", "high/out"}});
}

std::uint64_t idOf(const Workbench& w, const char* element, ScenePart::Kind kind = ScenePart::Kind::Element) {
    return sceneId({kind, w.session.document().elementNamed(element)->id, -1, false});
}

const render::Body* with(const render::Scene& scene, std::uint64_t id) {
    const auto at = std::find_if(scene.bodies.begin(), scene.bodies.end(), [&](const render::Body& body) { return body.id == id; });
    return at == scene.bodies.end() ? nullptr : &*at;
}

}  // namespace

TEST_CASE("whole characters: the render mesh is drawn, each of its triangles once, with the element that it follows") {
    Workbench w;
    buildCutTrunk(w);
    DocumentScene view;
    render::Scene scene;
    view.update(w.session, {}, scene);
    REQUIRE(scene.bodies.size() == 2);
    const auto& model = *w.session.document().characters.begin()->second->model;
    CHECK(scene.bodies[0].mesh->body.triangles.rows() + scene.bodies[1].mesh->body.triangles.rows() == model.mesh.body.triangles.rows());
    const render::Body *low = with(scene, idOf(w, "low")), *high = with(scene, idOf(w, "high"));
    REQUIRE(low != nullptr);
    REQUIRE(high != nullptr);
    for (const auto& [body, from, to] : {std::tuple{low, 0.0, 5.6}, std::tuple{high, 4.7, 12.0}}) {
        CHECK(body->mesh->body.vertices.col(2).minCoeff() >= from - kFloat);
        CHECK(body->mesh->body.vertices.col(2).maxCoeff() <= to + kFloat);
        CHECK(body->twoSided);
        for (Eigen::Index v = 0; v < body->mesh->body.vertices.rows(); ++v)
            CHECK((Eigen::Map<const Eigen::Vector3f>(body->positions + 3 * v).cast<double>() - body->mesh->body.vertices.row(v).transpose()).norm() < kFloat);
    }
    // Both have the same textures on the graphics card.
    CHECK(low->textures == high->textures);
    CHECK(low->textures.get() == &model.mesh);
    CHECK(scene.seams.empty());
}

TEST_CASE("whole characters: what is drawn follows the pose, and one mesh stays in one piece over a cut") {
    Workbench w;
    buildCutTrunk(w);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {4.0, 0.0, 10.0}}});
    DocumentScene view;
    render::Scene scene;
    view.update(w.session, {}, scene);
    REQUIRE(scene.bodies.size() == 2);
    Character* character = w.session.character();
    REQUIRE(character != nullptr);
    const Points whole = w.session.renderPositionsOf(w.session.document().characters.begin()->first);
    // Vertices that both parts have are at one place, and it is that of the render mesh.
    std::map<std::array<double, 3>, Eigen::Vector3f> places;  // by place at rest
    int shared = 0;
    for (const render::Body& body : scene.bodies)
        for (Eigen::Index v = 0; v < body.mesh->body.vertices.rows(); ++v) {
            const Vec3 rest = body.mesh->body.vertices.row(v);
            const Eigen::Vector3f now = Eigen::Map<const Eigen::Vector3f>(body.positions + 3 * v);
            const auto [at, isNew] = places.emplace(std::array{rest.x(), rest.y(), rest.z()}, now);
            if (isNew) continue;
            ++shared;
            CHECK(at->second == now);
        }
    CHECK(shared > 0);
    const auto& rest = w.session.document().characters.begin()->second->model->mesh.body.vertices;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        const auto at = places.find({rest(v, 0), rest(v, 1), rest(v, 2)});
        REQUIRE(at != places.end());
        CHECK((at->second.cast<double>() - whole.row(v).transpose()).norm() < kFloat);
    }
    const auto moved = w.session.positionOf({w.session.document().boneNamed("b")->id, true});
    REQUIRE(moved.has_value());
    CHECK(moved->x() > 1.0);
}

TEST_CASE("whole characters: elements hide, lock and are selected with what is seen of them; a selected character is selected all over") {
    Workbench w;
    buildCutTrunk(w);
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.selected = {idOf(w, "high")};
    w.good({{"do", "set"}, {"target", "low"}, {"property", "locked"}, {"value", true}});
    view.update(w.session, options, scene);
    REQUIRE(scene.bodies.size() == 2);
    CHECK(!with(scene, idOf(w, "low"))->pickable);
    CHECK(!with(scene, idOf(w, "low"))->selected);
    CHECK(with(scene, idOf(w, "high"))->selected);
    const PartId character = w.session.document().characters.begin()->first;
    options.selected = {sceneId({ScenePart::Kind::Character, character, -1, false})};
    view.update(w.session, options, scene);
    for (const render::Body& body : scene.bodies) CHECK(body.selected);
    w.good({{"do", "set"}, {"target", "low"}, {"property", "visible"}, {"value", false}});
    view.update(w.session, options, scene);
    REQUIRE(scene.bodies.size() == 1);
    CHECK(scene.bodies[0].id == idOf(w, "high"));
}

TEST_CASE("whole characters: bodies are shown on demand, under a render mesh that one sees through") {
    Workbench w;
    buildCutTrunk(w);
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.bodies = true;
    view.update(w.session, options, scene);
    REQUIRE(scene.bodies.size() == 4);
    const render::Body* body = with(scene, idOf(w, "low", ScenePart::Kind::Body));
    REQUIRE(body != nullptr);
    CHECK(body->mesh == w.session.document().elementNamed("low")->mesh);
    CHECK(!body->pickable);
    CHECK(with(scene, idOf(w, "low"))->opacity < body->opacity);
    REQUIRE(scene.seams.size() == 1);  // of the bodies
    CHECK(scene.bodies[static_cast<std::size_t>(scene.seams[0].a)].mesh == w.session.document().elementNamed("low")->mesh);
}

TEST_CASE("whole characters: a moved cut gives the elements beside it new meshes to draw and leaves the others theirs") {
    Workbench w;
    buildCutTrunk(w);
    w.good({{"do", "cut"}, {"element", "high"}, {"plane", {{"origin", {0, 0, 9.1}}, {"normal", {0, 0, 1}}}}, {"names", {"high", "tip"}}, {"name", "neck"}});
    DocumentScene view;
    render::Scene scene;
    view.update(w.session, {}, scene);
    const auto low = with(scene, idOf(w, "low"))->mesh, tip = with(scene, idOf(w, "tip"))->mesh;
    w.good({{"do", "move-cut"}, {"cut", "neck"}, {"plane", {{"origin", {0, 0, 8.3}}, {"normal", {0, 0, 1}}}}});
    view.update(w.session, {}, scene);
    CHECK(with(scene, idOf(w, "low"))->mesh == low);
    CHECK(with(scene, idOf(w, "tip"))->mesh != tip);
}

TEST_CASE("whole characters: a selected cut shows its rim and its plane where they are posed") {
    Workbench w;
    buildCutTrunk(w);
    const Cut& cut = w.session.document().characters.begin()->second->cuts[0];
    const auto frame = cutFrame(w.session, cut.id);
    REQUIRE(frame.has_value());
    CHECK((frame->centre - Vec3(0, 0, 5.1)).norm() < 1e-5);
    CHECK((frame->normal - Vec3::UnitZ()).norm() < 1e-5);
    CHECK(frame->elements[0] == w.session.document().elementNamed("low")->id);
    CHECK(frame->elements[1] == w.session.document().elementNamed("high")->id);
    REQUIRE(frame->rim.size() == 1);
    CHECK(frame->reach == doctest::Approx(std::sqrt(0.5)).epsilon(1e-5));
    CHECK((frame->atRest(Vec3(0.1, 0.2, 6.0)) - Vec3(0.1, 0.2, 6.0)).norm() < 1e-5);
    CHECK(!cutFrame(w.session, 9999).has_value());

    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    view.update(w.session, options, scene);
    CHECK(scene.markers.empty());
    options.selected = {sceneId({ScenePart::Kind::Cut, cut.id, -1, false})};
    view.update(w.session, options, scene);
    REQUIRE(scene.markers.size() == 2);
    CHECK(scene.markers[0].shape == render::Marker::Shape::FaceOutline);
    CHECK(scene.markers[1].shape == render::Marker::Shape::PlaneGizmo);
    CHECK(scene.markers[1].selected);
}

TEST_CASE("whole characters: a place that is pointed out is highlighted on the part that has it") {
    Workbench w;
    buildCutTrunk(w);
    const auto& source = *w.session.document().characters.begin()->second;
    MarkedPlace place{source.id, {0, static_cast<std::int32_t>(source.model->mesh.body.triangles.rows()) - 1}, Vec3(0.0, 0.5, 3.0)};
    DocumentScene view;
    render::Scene scene;
    SceneOptions options;
    options.marked = &place;
    view.update(w.session, options, scene);
    std::size_t highlighted = 0;
    for (const render::Body& body : scene.bodies)
        if (body.highlightedTriangles) highlighted += body.highlightedTriangles->size();
    CHECK(highlighted == 2);
    REQUIRE(scene.markers.size() == 1);
    CHECK((scene.markers[0].from - Vec3(0.0, 0.5, 3.0)).norm() < 1e-5);
}
