// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/snap.h"

#include <numbers>

#include "tests/tools/stage.h"
#include "ui/picking/picking.h"
#include "ui/tools/bone_tool.h"
#include "ui/tools/pose_tool.h"
#include "ui/tools/select_tool.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

SnapSettings only(bool SnapSettings::*what) {
    SnapSettings snap;
    snap.on = true;
    snap.grid = snap.angle = false;
    snap.*what = true;
    return snap;
}

/// Two joined bars with a bone in each, and a third bar that hangs together with nothing, above them.
struct SnapStage : ToolStage {
    EndpointRef tip, middle;
    SnapStage() {
        addTwoBones(*this);
        add("above", shapes::box(Vec3(0, 1.5, -0.5), Vec3(3, 2.5, 0.5), 6, 2, 2).mesh);
        tip = {now().boneNamed("bone 2")->id, true};
        middle = {now().boneNamed("bone 1")->id, true};
        look(ViewAxis::Front);
    }
    Vec3 restOf(const EndpointRef& end) { return *endpointRestPosition(now(), end); }
};

}  // namespace

TEST_CASE("snap: an end of a bone that is posed goes to a vertex nearby and stays there until the pointer clearly leaves it") {
    SnapStage stage;
    PoseTool tool(stage.document());
    tool.setOptions({{}, only(&SnapSettings::vertices)});
    const Vec3 corner(1.5, 1.5, 0.5);  // the box has a vertex there
    const double pixel = stage.at(0, 0, Qt::NoButton, {}).pixelSize;
    const auto target = [&] { return stage.now().goals.at(stage.tip).target; };
    stage.press(tool, Vec3(3, 0, 0));
    stage.pull(tool, corner + Vec3(25 * pixel, 10 * pixel, 0));
    CHECK((target() - corner).norm() > 20 * pixel);
    stage.pull(tool, corner + Vec3(8 * pixel, 0, 0));
    CHECK((target() - corner).norm() < 1e-6);
    CHECK(tool.hint().startsWith(QStringLiteral("To a vertex of above")));
    render::Scene scene;
    tool.decorate(scene);
    REQUIRE(!scene.markers.empty());
    CHECK(scene.markers.back().shape == render::Marker::Shape::SnapMark);
    CHECK((scene.markers.back().from - corner).norm() < 1e-6);
    // Left later than it was taken.
    stage.pull(tool, corner + Vec3(15 * pixel, 0, 0));
    CHECK((target() - corner).norm() < 1e-6);
    stage.pull(tool, corner + Vec3(22 * pixel, 0, 0));
    CHECK((target() - corner).norm() > 15 * pixel);
    tool.cancel();
    // What moves with the end is no place for it: the flesh would run away from itself.
    stage.press(tool, Vec3(3, 0, 0));
    stage.pull(tool, Vec3(2.5, 0.5, 0) + Vec3(3 * pixel, 0, 0));
    CHECK((target() - Vec3(2.5, 0.5, 0)).norm() == doctest::Approx(3 * pixel));
    tool.cancel();
}

TEST_CASE("snap: Ctrl turns the magnet round, and typed numbers win over it") {
    SnapStage stage;
    PoseTool tool(stage.document());
    SnapSettings snap = only(&SnapSettings::grid);
    snap.step = 0.25;
    tool.setOptions({{}, snap});
    const auto target = [&] { return stage.now().goals.at(stage.tip).target; };
    stage.press(tool, Vec3(3, 0, 0));
    stage.pull(tool, Vec3(2.8, 0.6, 0));
    CHECK((target() - Vec3(2.75, 0.5, 0)).norm() < 1e-9);
    stage.pull(tool, Vec3(2.8, 0.6, 0.0), Qt::ControlModifier);
    CHECK((target() - Vec3(2.8, 0.6, 0)).norm() < 1e-9);
    CHECK(tool.key(Qt::Key_Y, {}));
    stage.pull(tool, Vec3(2.8, 0.9, 0));
    CHECK((target() - Vec3(3, 1.0, 0)).norm() < 1e-9);
    for (const QChar sign : QStringLiteral("0.3")) CHECK(tool.key(Qt::Key_unknown, {}, QString(sign)));
    CHECK((target() - Vec3(3, 0.3, 0)).norm() < 1e-9);
    stage.letGo(tool, Vec3(2.8, 0.9, 0));
    snap.on = false;
    tool.setOptions({{}, snap});
    stage.press(tool, *endpointPosition(stage.session(), stage.tip));
    stage.pull(tool, Vec3(2.8, 0.6, 0), Qt::ControlModifier);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(std::remainder(target()[k], 0.25)) < 1e-9);
    tool.cancel();
}

TEST_CASE("snap: a bone's end at rest goes half-way through the flesh, or to where another end is, and keeps a place of its own") {
    SnapStage stage;
    stage.run({{"do", "add-bone"}, {"name", "free"}, {"from", {-2.0, 2.0, 0.0}}, {"to", {-1.0, 2.0, 0.0}}});
    stage.look(ViewAxis::Top);
    BoneTool tool(stage.document());
    const EndpointRef end{stage.now().boneNamed("free")->id, true};
    SnapSettings snap = only(&SnapSettings::middle);
    tool.setOptions({{}, snap});
    stage.press(tool, stage.restOf(end));
    stage.pull(tool, Vec3(1.3, 2.0, 0.2));
    CHECK(tool.hint().startsWith(QStringLiteral("To the middle of above")));
    stage.letGo(tool, Vec3(1.3, 2.0, 0.2));
    CHECK((stage.restOf(end) - Vec3(1.3, 2.0, 0.2)).norm() < 1e-6);
    snap = only(&SnapSettings::ends);
    tool.setOptions({{}, snap});
    stage.press(tool, stage.restOf(end));
    stage.pull(tool, stage.restOf(stage.tip));
    CHECK(tool.hint().startsWith(QStringLiteral("To bone 2/end")));
    const int before = stage.steps();
    stage.letGo(tool, stage.restOf(stage.tip));
    CHECK(stage.steps() == before + 1);
    CHECK((stage.restOf(end) - stage.restOf(stage.tip)).norm() < 1e-9);
    CHECK(std::holds_alternative<Vec3>(stage.now().boneNamed("free")->end));
}

TEST_CASE("snap: R turns bones by the typed step of angles, S scales them by tenths, without flicker between two steps") {
    SnapStage stage;
    stage.run({{"do", "add-bone"}, {"name", "free"}, {"from", {-2.0, 2.0, 0.0}}, {"to", {-1.0, 2.0, 0.0}}});
    BoneTool tool(stage.document());
    SnapSettings snap = only(&SnapSettings::angle);
    snap.grid = true;
    snap.angleStep = std::numbers::pi / 4.0;
    tool.setOptions({{}, snap});
    const PartId bone = stage.now().boneNamed("free")->id;
    stage.document().select({{Kind::Bone, bone, {}, false}});
    const Vec3 pivot(-1.5, 2.0, 0);
    const auto toward = [&](double degrees, double reach) { return Vec3(pivot + reach * Vec3(std::cos(degrees * std::numbers::pi / 180.0), std::sin(degrees * std::numbers::pi / 180.0), 0)); };
    stage.hover(tool, toward(0, 1));
    CHECK(tool.key(Qt::Key_R, {}));
    for (const double degrees : {10.0, 20.0, 30.0, 40.0}) stage.hover(tool, toward(degrees, 1));
    stage.hover(tool, toward(25, 1));  // nearer to none than to 45 degrees, which it has reached
    stage.click(tool, toward(25, 1));
    CHECK((stage.restOf({bone, true}) - toward(45, 0.5)).norm() < 1e-9);
    stage.hover(tool, toward(0, 1));
    CHECK(tool.key(Qt::Key_S, {}));
    stage.hover(tool, toward(0, 1.52));
    stage.click(tool, toward(0, 1.52));
    CHECK((stage.restOf({bone, true}) - toward(45, 0.75)).norm() < 1e-6);
}

TEST_CASE("snap: a cut goes through the end of a bone, and along the grid") {
    ToolStage stage;
    stage.add("body", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 12, 2, 2).mesh);
    stage.run({{"do", "make-character"}, {"element", "body"}});
    stage.run({{"do", "cut"}, {"element", "body"}, {"plane", {{"origin", {1.03, 0, 0}}, {"normal", {1, 0, 0}}}}, {"name", "waist"}});
    stage.run({{"do", "add-bone"}, {"name", "free"}, {"from", {-2.0, 1.0, 0.0}}, {"to", {-0.37, 1.0, 0.0}}});
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    PartId cut = 0;
    for (const auto& [id, character] : stage.now().characters) cut = character->cuts.front().id;
    stage.document().select({{Kind::Cut, cut, {}, false}});
    const auto place = [&] { return stage.now().characters.begin()->second->cuts.front().plane.origin.x(); };
    SnapSettings snap = only(&SnapSettings::ends);
    tool.setOptions({{}, snap});
    stage.press(tool, Vec3(1.03, 0, 0));
    stage.pull(tool, Vec3(-0.36, 1.0, 0));
    CHECK(tool.hint().startsWith(QStringLiteral("To free/end")));
    stage.letGo(tool, Vec3(-0.36, 1.0, 0));
    CHECK(place() == doctest::Approx(-0.37));
    snap = only(&SnapSettings::grid);
    snap.step = 0.2;
    tool.setOptions({{}, snap});
    stage.press(tool, Vec3(-0.37, 0, 0));
    stage.pull(tool, Vec3(0.67, 0, 0));
    stage.letGo(tool, Vec3(0.67, 0, 0));
    CHECK(place() == doctest::Approx(0.6));
}

TEST_CASE("snap: an end goes to the nearest point of an edge, posed or at rest, slides along it, and a vertex that is near wins") {
    SnapStage stage;
    const double pixel = stage.at(0, 0, Qt::NoButton, {}).pixelSize;
    SnapSettings edges = only(&SnapSettings::edges);
    PoseTool pose(stage.document());
    pose.setOptions({{}, edges});
    const auto target = [&] { return stage.now().goals.at(stage.tip).target; };
    // The rim of the box in front, from (0, 1.5, 0.5) to (3, 1.5, 0.5).
    stage.press(pose, Vec3(3, 0, 0));
    stage.pull(pose, Vec3(1.3, 1.5, 0.5) + Vec3(0, 5 * pixel, 0));
    CHECK((target() - Vec3(1.3, 1.5, 0.5)).norm() < 1e-6);
    CHECK(pose.hint().startsWith(QStringLiteral("To an edge of above")));
    stage.pull(pose, Vec3(1.2, 1.5, 0.5) + Vec3(0, -14 * pixel, 0));  // held as far as others are
    CHECK((target() - Vec3(1.2, 1.5, 0.5)).norm() < 1e-6);
    stage.pull(pose, Vec3(1.5, 1.5, 0.5) + Vec3(20 * pixel, 2 * pixel, 0));  // past the vertex there, on the next edge
    CHECK((target() - Vec3(1.5 + 20 * pixel, 1.5, 0.5)).norm() < 1e-6);
    edges.vertices = true;
    pose.setOptions({{}, edges});
    stage.pull(pose, Vec3(1.5, 1.5, 0.5) + Vec3(3 * pixel, 2 * pixel, 0));
    CHECK((target() - Vec3(1.5, 1.5, 0.5)).norm() < 1e-6);
    pose.cancel();
    edges.vertices = false;
    BoneTool bones(stage.document());
    ToolOptions options;
    options.snap = edges;
    bones.setOptions(options);
    stage.press(bones, Vec3(3, 0, 0));
    stage.pull(bones, Vec3(2.2, 1.5, 0.5) + Vec3(0, 4 * pixel, 0));
    stage.letGo(bones, Vec3(2.2, 1.5, 0.5) + Vec3(0, 4 * pixel, 0));
    CHECK((stage.restOf(stage.tip) - Vec3(2.2, 1.5, 0.5)).norm() < 1e-6);
}
