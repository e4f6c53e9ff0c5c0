// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/pose_fingers.h"

#include "tests/tools/stage.h"

using namespace imomushi;
using Landing = Tool::Landing;

namespace {

/// Fingers of a pose tool, at places of the document.
struct FingerStage : ToolStage {
    PoseTool tool{document()};
    PointerEvent finger(const Vec3& p) const {
        const auto s = screen(p);
        return at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton);
    }
    Landing land(int id, const Vec3& p) { return tool.fingerLanded(id, finger(p)); }
    void lead(int id, const Vec3& p) { tool.fingerMoved(id, finger(p)); }
    void lift(int id, const Vec3& p) { tool.fingerLifted(id, finger(p)); }
};

/// Two bones in a row, whose outer ends are taken.
struct Bones : FingerStage {
    EndpointRef left, right;
    Bones() {
        addTwoBones(*this);
        look(ViewAxis::Front);
        left = {now().boneNamed("bone 1")->id, false};
        right = {now().boneNamed("bone 2")->id, true};
    }
};

}  // namespace

TEST_CASE("pose fingers: two lead two ends; the mouse and keys wait until both are lifted, and Esc takes both back") {
    Bones stage;
    const int before = stage.steps();
    REQUIRE(stage.land(3, Vec3(3, 0, 0)) == Landing::Holds);
    REQUIRE(stage.land(8, Vec3(-3, 0, 0)) == Landing::Holds);
    CHECK(stage.document().selection().size() == 2);
    stage.lead(3, Vec3(2.8, 0.6, 0));
    REQUIRE(stage.now().goals.contains(stage.left));  // it has not moved, and is held
    CHECK((stage.now().goals.at(stage.left).target - Vec3(-3, 0, 0)).norm() < 1e-9);
    stage.lead(8, Vec3(-2.7, 0.5, 0));
    CHECK((stage.now().goals.at(stage.left).target - Vec3(-2.7, 0.5, 0)).norm() < 1e-9);
    CHECK((stage.now().goals.at(stage.right).target - Vec3(2.8, 0.6, 0)).norm() < 1e-9);
    CHECK(!stage.tool.wants(Qt::Key_P));
    CHECK(!stage.tool.key(Qt::Key_R, {}));
    stage.click(stage.tool, Vec3(0, 2, 0));
    CHECK(stage.tool.busy());
    CHECK(stage.document().selection().size() == 2);
    stage.tool.cancel();
    CHECK(!stage.tool.busy());
    CHECK(stage.now().goals.empty());
    CHECK(stage.steps() == before);
    stage.lead(3, Vec3(2, 1, 0));
    stage.lift(3, Vec3(2, 1, 0));
    CHECK(stage.now().goals.empty());
    CHECK(!stage.document().inGesture());
    CHECK(stage.refusals.empty());
}

TEST_CASE("pose fingers: an end that a finger has is not taken by another one, nothing is nothing, and taps make no step") {
    Bones stage;
    const int before = stage.steps();
    CHECK(stage.land(1, Vec3(0, 2, 0)) == Landing::FoundNothing);
    CHECK(!stage.tool.busy());
    CHECK(stage.land(1, Vec3(3, 0, 0)) == Landing::Holds);
    CHECK(stage.land(2, Vec3(3, 0, 0)) == Landing::FoundNothing);
    CHECK(stage.land(2, Vec3(0, 2, 0)) == Landing::FoundNothing);
    CHECK(stage.document().selection().size() == 1);
    CHECK(!stage.document().inGesture());
    stage.lift(1, Vec3(3, 0, 0));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before);
    CHECK(stage.now().goals.empty());
    // The mouse has it.
    stage.press(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.land(1, Vec3(-3, 0, 0)) == Landing::FoundNothing);
    stage.letGo(stage.tool, Vec3(3, 0, 0));
}

TEST_CASE("pose fingers: an end that is gone while it is led leaves the others as they are") {
    Bones stage;
    const int before = stage.steps();
    REQUIRE(stage.land(1, Vec3(3, 0, 0)) == Landing::Holds);
    REQUIRE(stage.land(2, Vec3(-3, 0, 0)) == Landing::Holds);
    stage.lead(2, Vec3(-2.7, 0.5, 0));
    (void)stage.made->execute({{"do", "remove-bone"}, {"name", "bone 2"}});
    stage.lead(1, Vec3(2, 1, 0));
    CHECK(stage.tool.busy());
    stage.lead(2, Vec3(-2.6, 0.6, 0));
    REQUIRE(stage.now().goals.contains(stage.left));
    CHECK((stage.now().goals.at(stage.left).target - Vec3(-2.6, 0.6, 0)).norm() < 1e-9);
    stage.lift(1, Vec3(2, 1, 0));
    stage.lift(2, Vec3(-2.6, 0.6, 0));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("pose fingers: two pull flesh by passing handles beside one that leads a handle, and one step of it remains") {
    FingerStage stage;
    stage.add("bar", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 24, 4, 4).mesh);
    for (const double x : {-2.5, 2.5}) stage.run({{"do", "handle"}, {"element", "bar"}, {"point", {x, 0, 0.5}}, {"radius", 0.3}});
    stage.run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    stage.run({{"do", "precompute"}});
    stage.look(ViewAxis::Front);
    stage.tool.setOptions({[](const Element&) { return true; }});
    const FaceRef handle{stage.element("bar").id, stage.element("bar").handles[1].face};
    const auto handles = [&] { return stage.element("bar").handles.size(); };
    const int before = stage.steps();
    REQUIRE(stage.land(1, Vec3(0, 0, 0.5)) == Landing::Holds);
    REQUIRE(stage.land(2, Vec3(2.5, 0, 0.5)) == Landing::Holds);
    CHECK(handles() == 2);
    stage.lead(1, Vec3(0, 0.4, 0.5));
    CHECK(handles() == 3);
    stage.lead(2, Vec3(2.5, -0.3, 0.5));
    REQUIRE(stage.land(3, Vec3(-1.2, 0, 0.5)) == Landing::Holds);
    CHECK(handles() == 4);
    stage.lead(3, Vec3(-1.2, 0.3, 0.5));
    const Vec3 origin = stage.element("bar").faces[1].frame.origin;
    CHECK((stage.session().poseOf(handle)->at - origin - Vec3(0, -0.3, 0)).norm() < 1e-6);
    stage.lift(1, Vec3(0, 0.4, 0.5));
    CHECK(handles() == 3);
    stage.lead(2, Vec3(2.5, -0.4, 0.5));
    CHECK((stage.session().poseOf(handle)->at - origin - Vec3(0, -0.4, 0)).norm() < 1e-6);
    stage.lift(3, Vec3(-1.2, 0.3, 0.5));
    stage.lift(2, Vec3(2.5, -0.4, 0.5));
    CHECK(handles() == 2);
    CHECK(stage.now().handleGoals.contains(handle));
    CHECK(stage.now().handleGoals.size() == 1);
    CHECK(stage.steps() == before + 1);
    CHECK(stage.session().steps().back().name == "drag");
    stage.run({{"do", "undo"}});
    CHECK(stage.now().handleGoals.empty());
    CHECK(stage.refusals.empty());
}
