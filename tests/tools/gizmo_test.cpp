// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/gizmo.h"

#include <numbers>

#include "tests/tools/stage.h"
#include "ui/picking/picking.h"
#include "ui/tools/bone_tool.h"
#include "ui/tools/pose_tool.h"
#include "ui/tools/select_tool.h"

using namespace imomushi;
using render::GizmoPart;
using Kind = SelectionItem::Kind;
using Sizes = render::GizmoSizes;

namespace {

struct GizmoStage : ToolStage {
    PartId bone = 0;
    GizmoStage() {
        addTwoBones(*this);
        run({{"do", "add-bone"}, {"name", "free"}, {"from", {-2.0, 1.0, 0.0}}, {"to", {-1.0, 1.0, 0.0}}});
        bone = now().boneNamed("free")->id;
        look(ViewAxis::Front);
    }
    [[nodiscard]] double pixel() const { return at(0, 0, Qt::NoButton, {}).pixelSize; }
    Vec3 restOf(bool atEnd) { return *endpointRestPosition(now(), {bone, atEnd}); }
    [[nodiscard]] bool shows(const Tool& tool) const {
        render::Scene scene;
        scene.camera.orthographic = true;
        tool.decorate(scene);
        return std::any_of(scene.markers.begin(), scene.markers.end(), [](const render::Marker& m) { return m.shape == render::Marker::Shape::Gizmo; });
    }
};

}  // namespace

TEST_CASE("gizmo: parts are found where they are drawn, in pixels, and what is seen end on or from its edge is not found") {
    GizmoStage stage;
    const double pixel = stage.pixel();
    const GizmoPlace place{Vec3(0.3, 0.2, 0.1), Eigen::Matrix3d::Identity(), true, true};
    const auto under = [&](const Vec3& pixels) {
        const auto s = stage.screen(place.at + pixel * pixels);
        return gizmoUnder(stage.at(s.x(), s.y(), Qt::NoButton, {}), place, GizmoSpace::World);
    };
    CHECK(under(Vec3(50, 3, 0)) == GizmoPart::AxisX);
    CHECK(under(Vec3(-3, 80, 0)) == GizmoPart::AxisY);
    CHECK(under(Vec3(30, 30, 0)) == GizmoPart::PlaneZ);
    CHECK(under(Vec3(2, 2, 0)) == GizmoPart::Middle);
    CHECK(under(Vec3(Sizes::kScale, 0, 0)) == GizmoPart::ScaleX);
    CHECK(under(Sizes::kRing * Vec3(-0.6, 0.8, 0)) == GizmoPart::RingZ);
    CHECK(under(Sizes::kRingView * Vec3(-0.6, 0.8, 0)) == GizmoPart::RingView);
    CHECK(under(Vec3(-40, -20, 0)) == GizmoPart::None);
    // Z is looked along, and the planes across X and Y are seen from their edges; their rings, too.
    for (int x = -125; x <= 125; x += 5)
        for (int y = -125; y <= 125; y += 5)
            for (const GizmoPart no : {GizmoPart::AxisZ, GizmoPart::PlaneX, GizmoPart::PlaneY, GizmoPart::RingX, GizmoPart::RingY, GizmoPart::ScaleZ}) CHECK(under(Vec3(x, y, 0)) != no);
    // A view turned by a few degrees does not bring them back at once.
    CHECK(render::axisFade(Vec3::UnitZ(), Vec3(std::sin(0.09), 0, -std::cos(0.09))) == 0.0);
    CHECK(render::axisFade(Vec3::UnitZ(), Vec3(0.5, 0, -std::sqrt(0.75))) == 1.0);
}

TEST_CASE("gizmo: an axis moves an end of a bone at rest along it alone, numbers and Esc as in every drag, one undo step") {
    GizmoStage stage;
    BoneTool tool(stage.document());
    CHECK(!stage.shows(tool));
    stage.document().select({{Kind::Endpoint, stage.bone, {}, true}});
    CHECK(stage.shows(tool));
    const Vec3 from = stage.restOf(true), grip = from + 60 * stage.pixel() * Vec3::UnitY();
    const int before = stage.steps();
    stage.press(tool, grip);
    stage.pull(tool, grip + Vec3(0.3, 0.4, 0));
    CHECK(!stage.shows(tool));
    stage.letGo(tool, grip + Vec3(0.3, 0.4, 0));
    CHECK((stage.restOf(true) - from - Vec3(0, 0.4, 0)).norm() < 1e-6);
    CHECK(stage.steps() == before + 1);
    stage.run({{"do", "undo"}});
    stage.press(tool, grip);
    stage.pull(tool, grip + Vec3(0.3, 0.4, 0));
    for (const QChar sign : QStringLiteral("25 cm")) CHECK(tool.key(Qt::Key_unknown, {}, QString(sign)));
    stage.letGo(tool, grip);
    CHECK((stage.restOf(true) - from - Vec3(0, 0.25, 0)).norm() < 1e-6);
    stage.run({{"do", "undo"}});
    stage.press(tool, grip);
    stage.pull(tool, grip + Vec3(0.3, 0.4, 0));
    tool.cancel();
    CHECK((stage.restOf(true) - from).norm() < 1e-9);
    CHECK(stage.steps() == before);
    // A click on it neither moves the end nor places a bone.
    stage.click(tool, grip);
    CHECK(stage.steps() == before);
    CHECK(!tool.pending());
}

TEST_CASE("gizmo: rings turn a bone, boxes scale it along its own axis, and the middle moves it") {
    GizmoStage stage;
    BoneTool tool(stage.document());
    ToolOptions options;
    options.space = GizmoSpace::Local;
    tool.setOptions(options);
    stage.document().select({{Kind::Bone, stage.bone, {}, false}});
    const Vec3 middle(-1.5, 1.0, 0);
    const auto about = [&](double degrees) { return Vec3(middle + Sizes::kRing * stage.pixel() * Vec3(std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180), 0)); };
    stage.press(tool, about(130));
    stage.pull(tool, about(175));
    stage.pull(tool, about(220));
    stage.letGo(tool, about(220));
    CHECK((stage.restOf(true) - middle - Vec3(0, 0.5, 0)).norm() < 1e-6);
    // Its own first axis goes up now.
    const Vec3 box = middle + Sizes::kScale * stage.pixel() * Vec3::UnitY();
    stage.press(tool, box);
    stage.pull(tool, middle + 2.0 * (box - middle));
    stage.letGo(tool, middle + 2.0 * (box - middle));
    CHECK((stage.restOf(true) - middle - Vec3(0, 1.0, 0)).norm() < 1e-6);
    stage.press(tool, middle);
    stage.pull(tool, middle + Vec3(0.2, -0.3, 0));
    stage.letGo(tool, middle + Vec3(0.2, -0.3, 0));
    CHECK((0.5 * (stage.restOf(true) + stage.restOf(false)) - middle - Vec3(0.2, -0.3, 0)).norm() < 1e-6);
}

TEST_CASE("gizmo: the select tool moves the selected end of a posed bone by a plane, and turns a handle by a ring; it is not shown where options or Shift say no") {
    GizmoStage stage;
    SelectTool tool(stage.document());
    const EndpointRef tip{stage.now().boneNamed("bone 2")->id, true};
    stage.document().select({{Kind::Endpoint, tip.bone, {}, true}});
    CHECK(stage.shows(tool));
    const Vec3 plane = Vec3(3, 0, 0) + 30 * stage.pixel() * Vec3(1, 1, 0);
    stage.press(tool, plane);
    stage.pull(tool, plane + Vec3(-0.2, 0.3, 0));
    stage.letGo(tool, plane + Vec3(-0.2, 0.3, 0));
    CHECK((stage.now().goals.at(tip).target - Vec3(2.8, 0.3, 0)).norm() < 1e-6);
    stage.run({{"do", "rest"}});
    const auto made = stage.document().execute({{"do", "handle"}, {"element", "left"}, {"point", {-1.5, 0.5, 0.0}}, {"radius", 0.3}});
    REQUIRE(made);
    const std::string knob = made->at("name").get<std::string>();
    const PartId left = stage.now().elementNamed("left")->id;
    stage.document().select({{Kind::Face, left, knob, false}});
    const Vec3 at = stage.session().poseOf({left, knob})->at;
    const auto about = [&](double degrees) { return Vec3(at + Sizes::kRing * stage.pixel() * Vec3(std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180), 0)); };
    stage.press(tool, about(130));
    stage.pull(tool, about(150));
    stage.pull(tool, about(160));
    stage.letGo(tool, about(160));
    const auto pose = stage.session().poseOf({left, knob});
    REQUIRE(pose);
    CHECK(Eigen::AngleAxisd(pose->rotation).angle() == doctest::Approx(30 * std::numbers::pi / 180).epsilon(0.01));
    CHECK((Eigen::AngleAxisd(pose->rotation).axis() - Vec3::UnitZ()).norm() < 0.01);
    ToolOptions options;
    options.gizmo = false;
    tool.setOptions(options);
    CHECK(!stage.shows(tool));
}

TEST_CASE("gizmo: it has what moves, turns or scales alone where that is chosen, and what there is where it cannot") {
    GizmoStage stage;
    stage.add("alone", shapes::box(Vec3(-1, 2, -0.5), Vec3(1, 3, 0.5), 2, 2, 2).mesh);
    const Vec3 middle(0, 2.5, 0);
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    stage.document().select({{Kind::Element, stage.element("alone").id, {}, false}});
    const double pixel = stage.pixel();
    const Vec3 arrow = middle + 46 * pixel * Vec3::UnitX(), box = middle + Sizes::kScale * pixel * Vec3::UnitX(), ring = middle + Sizes::kRing * pixel * Vec3(-0.6, 0.8, 0);
    const auto takes = [&](const Vec3& p) {
        stage.press(tool, p);
        const bool taken = tool.busy() && !tool.box();
        stage.pull(tool, p + Vec3(0.1, 0.1, 0));
        const bool drags = taken && !tool.box();
        tool.cancel();
        stage.document().select({{Kind::Element, stage.element("alone").id, {}, false}});
        return drags;
    };
    ToolOptions options;
    for (const auto& [parts, moves, turns, scales] : {std::tuple{GizmoParts::All, true, true, true}, {GizmoParts::Move, true, false, false}, {GizmoParts::Turn, false, true, false}, {GizmoParts::Scale, false, false, true}}) {
        CAPTURE(int(parts));
        options.parts = parts;
        tool.setOptions(options);
        CHECK(takes(arrow) == moves);
        CHECK(takes(ring) == turns);
        CHECK(takes(box) == scales);
        render::Scene scene;
        scene.camera.orthographic = true;
        tool.decorate(scene);
        REQUIRE(scene.markers.size() == 1);
        CHECK(scene.markers[0].gizmo->moves == moves);
        CHECK(scene.markers[0].gizmo->turns == turns);
        CHECK(scene.markers[0].gizmo->scales == scales);
    }
    // The end of a bone cannot be scaled: it keeps its arrows.
    const GizmoPlace end = withParts({Vec3::Zero(), Eigen::Matrix3d::Identity(), false, false}, GizmoParts::Scale);
    CHECK(end.moves);
    CHECK(!end.scales);
}
