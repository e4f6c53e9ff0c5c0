// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/character_input.h"
#include "tests/tools/stage.h"
#include "ui/tools/bone_tool.h"
#include "ui/tools/pose_tool.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

/// A bar along x, its middle at `middle`.
void addMirroredBody(ToolStage& stage, double middle = 0.0) {
    stage.add("body", shapes::box(Vec3(middle - 3, -1, -0.5), Vec3(middle + 3, 1, 0.5), 6, 2, 2).mesh);
    stage.look(ViewAxis::Front);
}

void addSide(ToolStage& stage, const char* name, const Vec3& from, const Vec3& to) {
    stage.run({{"do", "add-bone"}, {"name", name}, {"element", "body"}, {"from", {from.x(), from.y(), from.z()}}, {"to", {to.x(), to.y(), to.z()}}});
}

Vec3 atRest(ToolStage& stage, const char* bone, bool atEnd) {
    const Bone* found = stage.now().boneNamed(bone);
    REQUIRE(found);
    const auto at = restPosition(stage.now(), atEnd ? found->end : found->start);
    REQUIRE(at);
    return *at;
}

ToolOptions mirrored() {
    ToolOptions options;
    options.symmetry = true;
    options.gizmo = false;
    return options;
}

constexpr double kScreen = 0.02;  // m: less than a pixel of the view

}  // namespace

TEST_CASE("symmetry: bones that are placed on one side are on the other, with names of sides, as one step each") {
    ToolStage stage;
    addMirroredBody(stage, 5.0);
    BoneTool tool(stage.document());
    tool.setOptions(mirrored());
    const int before = stage.steps();
    stage.click(tool, Vec3(5.8, 0, 0));
    stage.click(tool, Vec3(6.6, 0.3, 0));
    CHECK(stage.steps() == before + 1);
    REQUIRE(stage.now().bones.size() == 2);
    for (const bool atEnd : {false, true}) {
        const Vec3 left = atRest(stage, "bone 1.L", atEnd), right = atRest(stage, "bone 1.R", atEnd);
        CHECK((right - Vec3(10.0 - left.x(), left.y(), left.z())).norm() < 1e-9);
    }
    // The chain goes on, on both sides.
    stage.click(tool, Vec3(7.4, 0, 0));
    REQUIRE(stage.now().bones.size() == 4);
    CHECK(std::get<EndpointRef>(stage.now().boneNamed("bone 2.R")->start) == EndpointRef{stage.now().boneNamed("bone 1.R")->id, true});
    CHECK(stage.refusals.empty());
    stage.run({{"do", "undo"}});
    stage.run({{"do", "undo"}});
    CHECK(stage.now().bones.empty());
    // What lies in the plane is its own other side.
    tool.cancel();
    stage.click(tool, Vec3(5, -0.5, 0));
    stage.click(tool, Vec3(5, 0.5, 0));
    CHECK(stage.now().bones.size() == 1);
    CHECK(stage.now().boneNamed("bone 1"));
}

TEST_CASE("symmetry: an end that is dragged takes the one on the other side along, by names or by places, and one undo takes both back") {
    for (const auto& [left, right] : {std::pair{"arm.L", "arm.R"}, {"one", "two"}}) {
        CAPTURE(left);
        ToolStage stage;
        addMirroredBody(stage);
        addSide(stage, left, {0.5, 0, 0}, {2, 0, 0});
        addSide(stage, right, {-0.5, 0, 0}, {-2, 0, 0});
        BoneTool tool(stage.document());
        tool.setOptions(mirrored());
        const int before = stage.steps();
        stage.press(tool, Vec3(2, 0, 0));
        stage.pull(tool, Vec3(2.3, 0.2, 0));
        stage.pull(tool, Vec3(2.5, 0.4, 0));
        render::Scene scene;
        tool.decorate(scene);
        const auto shown = [&](const Vec3& p) { return std::any_of(scene.markers.begin(), scene.markers.end(), [&](const render::Marker& m) { return (m.to - p).norm() < kScreen; }); };
        CHECK(shown({2.5, 0.4, 0}));
        CHECK(shown({-2.5, 0.4, 0}));
        stage.letGo(tool, Vec3(2.5, 0.4, 0));
        CHECK(stage.steps() == before + 1);
        CHECK((atRest(stage, left, true) - Vec3(2.5, 0.4, 0)).norm() < kScreen);
        CHECK((atRest(stage, right, true) - Vec3(-atRest(stage, left, true).x(), atRest(stage, left, true).y(), atRest(stage, left, true).z())).norm() < 1e-9);
        CHECK(atRest(stage, right, false) == Vec3(-0.5, 0, 0));
        CHECK(stage.refusals.empty());
        stage.run({{"do", "undo"}});
        CHECK(atRest(stage, left, true) == Vec3(2, 0, 0));
        CHECK(atRest(stage, right, true) == Vec3(-2, 0, 0));
    }
}

TEST_CASE("symmetry: what has nothing on the other side moves alone, and that is said") {
    ToolStage stage;
    addMirroredBody(stage);
    addSide(stage, "arm.L", {0.5, 0, 0}, {2, 0, 0});
    BoneTool bones(stage.document());
    bones.setOptions(mirrored());
    stage.press(bones, Vec3(2, 0, 0));
    stage.pull(bones, Vec3(2.5, 0.4, 0));
    stage.letGo(bones, Vec3(2.5, 0.4, 0));
    CHECK(atRest(stage, "arm.L", true).x() > 2.4);
    REQUIRE(stage.refusals.size() == 1);
    CHECK(stage.refusals[0].contains(QStringLiteral("arm.L/end")));
    // Without symmetry nothing is.
    bones.setOptions({});
    stage.press(bones, Vec3(2.5, 0.4, 0));
    stage.pull(bones, Vec3(2, 0, 0));
    stage.letGo(bones, Vec3(2, 0, 0));
    CHECK(stage.refusals.size() == 1);
}

TEST_CASE("symmetry: a posed end takes the other side along, where it mirrors it, as one step") {
    ToolStage stage;
    addMirroredBody(stage);
    addSide(stage, "arm.L", {0.5, 0, 0}, {2, 0, 0});
    addSide(stage, "arm.R", {-0.5, 0, 0}, {-2, 0, 0});
    PoseTool tool(stage.document());
    tool.setOptions(mirrored());
    const int before = stage.steps();
    stage.press(tool, Vec3(2, 0, 0));
    stage.pull(tool, Vec3(1.9, 0.2, 0));
    stage.pull(tool, Vec3(1.7, 0.6, 0));
    stage.letGo(tool, Vec3(1.7, 0.6, 0));
    CHECK(stage.steps() == before + 1);
    const auto target = [&](const char* bone) {
        const auto goal = stage.now().goals.find({stage.now().boneNamed(bone)->id, true});
        REQUIRE(goal != stage.now().goals.end());
        return goal->second.target;
    };
    CHECK((target("arm.L") - Vec3(1.7, 0.6, 0)).norm() < kScreen);
    CHECK((target("arm.R") - Vec3(-target("arm.L").x(), target("arm.L").y(), target("arm.L").z())).norm() < 1e-12);
    stage.run({{"do", "undo"}});
    CHECK(stage.now().goals.empty());
    // In mid-drag Esc takes both back.
    stage.press(tool, Vec3(2, 0, 0));
    stage.pull(tool, Vec3(1.7, 0.6, 0));
    tool.cancel();
    CHECK(stage.now().goals.empty());
    CHECK(stage.steps() == before);
}
