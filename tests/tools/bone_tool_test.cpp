// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/bone_tool.h"

#include "tests/tools/stage.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

/// addTwoBones() without its bones.
void addTwoFacedBars(ToolStage& stage) {
    addTwoBones(stage);
    stage.run({{"do", "remove-bone"}, {"name", "bone 2"}});
    stage.run({{"do", "remove-bone"}, {"name", "bone 1"}});
}

}  // namespace

TEST_CASE("bone tool: clicks from face to face make a chain through the elements") {
    ToolStage stage;
    addTwoFacedBars(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(-3, 0.01, 0));
    CHECK(tool.pending());
    CHECK(stage.steps() == before);
    stage.click(tool, Vec3(0, 0.01, 0));
    stage.click(tool, Vec3(3, 0.01, 0));
    CHECK(stage.steps() == before + 2);
    const Bone* first = stage.now().boneNamed("bone 1");
    const Bone* second = stage.now().boneNamed("bone 2");
    REQUIRE(first);
    REQUIRE(second);
    CHECK(first->element == stage.element("left").id);
    CHECK(second->element == stage.element("right").id);
    CHECK(first->start == Bone::Place(FaceRef{stage.element("left").id, "tail"}));
    CHECK(first->end == Bone::Place(FaceRef{stage.element("left").id, "joint"}));
    CHECK(second->start == Bone::Place(EndpointRef{first->id, true}));
    CHECK(second->end == Bone::Place(FaceRef{stage.element("right").id, "tip"}));
    CHECK(second->parent == first->id);
    CHECK(stage.session().pointIndex({first->id, true}) == stage.session().pointIndex({second->id, false}));
    CHECK(stage.selected() == SelectionItem{Kind::Bone, second->id, {}, false});
    tool.cancel();
    CHECK(!tool.pending());
    CHECK(stage.refusals.empty());
}

TEST_CASE("bone tool: the last bone can be undone and the chain goes on from what is left") {
    ToolStage stage;
    addTwoFacedBars(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    stage.click(tool, Vec3(-3, 0.01, 0));
    stage.click(tool, Vec3(0, 0.01, 0));
    stage.run({{"do", "undo"}});
    stage.hover(tool, Vec3(-3, 0.01, 0));
    CHECK(!tool.pending());  // the end it would have gone on from is gone
    stage.click(tool, Vec3(-3, 0.01, 0));
    stage.click(tool, Vec3(0, 0.01, 0));
    CHECK(stage.now().bones.size() == 1);
}

TEST_CASE("bone tool: a new chain that begins at a joint with a bone shares its end") {
    ToolStage stage;
    addTwoFacedBars(stage);
    stage.run({{"do", "add-bone"}, {"name", "trunk"}, {"element", "left"}, {"from", "left/tail"}, {"to", "left/joint"}});
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    stage.click(tool, Vec3(0, 0.01, 0));
    stage.click(tool, Vec3(3, 0.01, 0));
    const Bone* bone = stage.now().boneNamed("bone 1");
    REQUIRE(bone);
    CHECK(bone->parent == stage.now().boneNamed("trunk")->id);
    CHECK(bone->element == stage.element("right").id);
}

TEST_CASE("bone tool: inside a body the point goes to the middle of the volume under the pointer") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    stage.click(tool, Vec3(0.5, 0.1, 0));
    stage.click(tool, Vec3(2.5, -0.1, 0));
    const Bone* bone = stage.now().boneNamed("bone 1");
    REQUIRE(bone);
    REQUIRE(std::holds_alternative<Vec3>(bone->start));
    CHECK((std::get<Vec3>(bone->start) - Vec3(0.5, 0.1, 0)).norm() < 1e-6);
    CHECK((std::get<Vec3>(bone->end) - Vec3(2.5, -0.1, 0)).norm() < 1e-6);
    CHECK(bone->element == stage.element("right").id);
}

TEST_CASE("bone tool: two clicks on one place make no bone and say so; a click on nothing does nothing") {
    ToolStage stage;
    addTwoFacedBars(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(-3, 0.01, 0));
    stage.click(tool, Vec3(-3, 0.01, 0));
    CHECK(stage.refusals.size() == 1);
    stage.click(tool, Vec3(0, 1.3, 0));
    CHECK(stage.steps() == before);
    CHECK(tool.pending());
}

TEST_CASE("bone tool: Shift+click on an end starts a branch there") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    stage.click(tool, Vec3(-3, 0.0, 0));
    stage.click(tool, Vec3(0, 0.0, 0), Qt::ShiftModifier);  // not a bone from -3 to 0: a new start
    CHECK(stage.now().bones.size() == 2);
    stage.click(tool, Vec3(1.5, 0.35, 0));
    const Bone* branch = stage.now().boneNamed("bone 3");
    REQUIRE(branch);
    CHECK(branch->parent == stage.now().boneNamed("bone 1")->id);
    CHECK(branch->element == stage.element("right").id);
}

TEST_CASE("bone tool: shows bodies like glass, the bone to come and its ends") {
    ToolStage stage;
    addTwoFacedBars(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    stage.click(tool, Vec3(-3, 0.01, 0));
    stage.hover(tool, Vec3(0, 0.01, 0));
    render::Scene scene;
    scene.bodies.resize(2);
    tool.decorate(scene);
    CHECK(scene.bodies[1].opacity < 1.0f);
    REQUIRE(scene.markers.size() == 3);
    CHECK(scene.markers[0].shape == render::Marker::Shape::Bone);
    CHECK((scene.markers[0].from - Vec3(-3, 0, 0)).norm() < 1e-6);
    CHECK((scene.markers[0].to - Vec3(0, 0, 0)).norm() < 1e-6);
}

TEST_CASE("bone tool: an end that is there is dragged at rest, with all bones that meet there, in one step") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    const int before = stage.steps();
    stage.press(tool, Vec3(0, 0, 0));
    CHECK(tool.busy());
    stage.pull(tool, Vec3(0.4, 0.2, 0));
    CHECK(stage.steps() == before);  // only shown
    render::Scene scene;
    tool.decorate(scene);
    CHECK(scene.markers.size() == 3);
    stage.letGo(tool, Vec3(0.4, 0.2, 0));
    CHECK(stage.refusals.empty());
    CHECK(stage.steps() == before + 1);
    const Bone* first = stage.now().boneNamed("bone 1");
    const Bone* second = stage.now().boneNamed("bone 2");
    REQUIRE(std::holds_alternative<Vec3>(first->end));
    CHECK((std::get<Vec3>(first->end) - Vec3(0.4, 0.2, 0)).norm() < 1e-9);
    CHECK(second->start == Bone::Place(EndpointRef{first->id, true}));
    CHECK((*endpointPosition(stage.session(), {second->id, false}) - Vec3(0.4, 0.2, 0)).norm() < 1e-9);
    CHECK(!tool.pending());
    // And back to the centre of the joint face, which it takes.
    stage.press(tool, Vec3(0.4, 0.2, 0));
    stage.pull(tool, Vec3(0.02, 0.01, 0));
    stage.letGo(tool, Vec3(0.02, 0.01, 0));
    CHECK(std::holds_alternative<FaceRef>(stage.now().boneNamed("bone 1")->end));
    stage.run({{"do", "undo"}});
    stage.run({{"do", "undo"}});
    CHECK(stage.now().boneNamed("bone 1")->end == Bone::Place(FaceRef{stage.element("left").id, "joint"}));
}

TEST_CASE("bone tool: numbers are typed while an end is dragged, and Esc leaves it where it was") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    const int before = stage.steps();
    stage.press(tool, Vec3(3, 0, 0));
    CHECK(tool.key(Qt::Key_Y, {}, QStringLiteral("y")));
    for (const QChar sign : QStringLiteral("10 cm")) CHECK(tool.key(0, {}, QString(sign)));
    CHECK(tool.banner().contains(QStringLiteral("10 cm")));
    stage.letGo(tool, Vec3(3, 0, 0));
    CHECK((std::get<Vec3>(stage.now().boneNamed("bone 2")->end) - Vec3(3, 0.1, 0)).norm() < 1e-9);
    CHECK(stage.steps() == before + 1);
    stage.press(tool, Vec3(3, 0.1, 0));
    stage.pull(tool, Vec3(2, 0.3, 0));
    tool.cancel();
    CHECK(!tool.busy());
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("bone tool: G, R and S move, turn and scale the selected bones without a button") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    BoneTool tool(stage.document());
    const auto type = [&](const QString& signs) {
        for (const QChar sign : signs) CHECK(tool.key(0, {}, QString(sign)));
    };
    const auto at = [&](const char* bone, bool end) { return *endpointRestPosition(stage.now(), {stage.now().boneNamed(bone)->id, end}); };
    CHECK(!tool.wants(Qt::Key_G));
    stage.hover(tool, Vec3(1, 1.2, 0));
    stage.document().select({SelectionItem{Kind::Bone, stage.now().boneNamed("bone 2")->id, {}, false}});
    CHECK(tool.wants(Qt::Key_R));
    const int before = stage.steps();
    // A quarter turn about the middle of the bone, which stays.
    CHECK(tool.key(Qt::Key_R, {}, QStringLiteral("r")));
    CHECK(tool.modal());
    type(QStringLiteral("90"));
    stage.press(tool, Vec3(1, 1.2, 0));
    CHECK(!tool.busy());
    CHECK(stage.steps() == before + 1);
    CHECK((at("bone 2", false) - Vec3(1.5, -1.5, 0)).norm() < 1e-9);
    CHECK((at("bone 2", true) - Vec3(1.5, 1.5, 0)).norm() < 1e-9);
    stage.run({{"do", "undo"}});
    CHECK(tool.key(Qt::Key_S, {}, QStringLiteral("s")));
    type(QStringLiteral("50%"));
    CHECK(tool.key(Qt::Key_Return, {}, {}));
    CHECK((at("bone 2", false) - Vec3(0.75, 0, 0)).norm() < 1e-9);
    CHECK((at("bone 2", true) - Vec3(2.25, 0, 0)).norm() < 1e-9);
    stage.run({{"do", "undo"}});
    // By the pointer, along one axis.
    CHECK(tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    CHECK(tool.key(Qt::Key_Y, {}, QStringLiteral("y")));
    stage.hover(tool, Vec3(2, 1.5, 0));
    stage.press(tool, Vec3(2, 1.5, 0));
    CHECK((at("bone 2", true) - Vec3(3, 0.3, 0)).norm() < 1e-6);
    stage.run({{"do", "undo"}});
    CHECK(tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    tool.cancel();
    CHECK((at("bone 2", true) - Vec3(3, 0, 0)).norm() < 1e-9);
    CHECK(stage.steps() == before);
}
