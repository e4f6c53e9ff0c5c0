// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/pose_tool.h"

#include <cmath>

#include "tests/tools/stage.h"
#include "ui/picking/picking.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

struct PoseStage : ToolStage {
    PoseTool tool{document()};
    EndpointRef tip;
    PoseStage() {
        addTwoBones(*this);
        look(ViewAxis::Front);
        tip = {now().boneNamed("bone 2")->id, true};
    }
    const EndpointGoal* held() {
        const auto found = now().goals.find(tip);
        return found == now().goals.end() ? nullptr : &found->second;
    }
};

}  // namespace

TEST_CASE("pose tool: a drag moves the end with the pointer and is one undo step") {
    PoseStage stage;
    const int before = stage.steps();
    stage.press(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.tool.busy());
    for (int i = 1; i <= 10; ++i) stage.pull(stage.tool, Vec3(3 - 0.02 * i, 0.1 * i, 0));
    stage.letGo(stage.tool, Vec3(2.8, 1.0, 0));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 1);
    REQUIRE(stage.held());
    CHECK((stage.held()->target - Vec3(2.8, 1.0, 0)).norm() < 1e-9);
    const auto at = endpointPosition(stage.session(), stage.tip);
    REQUIRE(at);
    CHECK((*at - Vec3(2.8, 1.0, 0)).norm() < 0.05);
    stage.run({{"do", "undo"}});
    CHECK(!stage.held());
    CHECK((*endpointPosition(stage.session(), stage.tip) - Vec3(3, 0, 0)).norm() < 1e-9);
}

TEST_CASE("pose tool: a click selects the end and makes no step") {
    PoseStage stage;
    const int before = stage.steps();
    stage.click(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.steps() == before);
    CHECK(stage.selected() == SelectionItem{Kind::Endpoint, stage.tip.bone, {}, true});
}

TEST_CASE("pose tool: cancelling a drag restores the pose and leaves no step and no open gesture") {
    PoseStage stage;
    const int before = stage.steps();
    stage.press(stage.tool, Vec3(3, 0, 0));
    stage.pull(stage.tool, Vec3(2, 1, 0));
    REQUIRE(stage.held());
    stage.tool.cancel();
    CHECK(!stage.tool.busy());
    CHECK(!stage.held());
    CHECK(stage.steps() == before);
    CHECK((*endpointPosition(stage.session(), stage.tip) - Vec3(3, 0, 0)).norm() < 1e-9);
    stage.pull(stage.tool, Vec3(1, 1, 0));
    stage.letGo(stage.tool, Vec3(1, 1, 0));
    CHECK(stage.steps() == before);
    stage.run({{"do", "pin"}, {"endpoint", "bone 1/start"}});
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("pose tool: a tool that goes away in mid-drag takes the drag back") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    const int before = stage.steps();
    {
        PoseTool tool(stage.document());
        stage.press(tool, Vec3(3, 0, 0));
        stage.pull(tool, Vec3(2, 1, 0));
    }
    CHECK(stage.steps() == before);
    CHECK(stage.now().goals.empty());
}

TEST_CASE("pose tool: X, Y and Z lock the drag to an axis, again frees it") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    stage.pull(stage.tool, Vec3(2.9, 0.1, 0));
    CHECK(stage.tool.key(Qt::Key_Y, {}));
    stage.pull(stage.tool, Vec3(2.5, 0.6, 0));
    REQUIRE(stage.held());
    CHECK(stage.held()->target.x() == doctest::Approx(3.0));
    CHECK(stage.held()->target.z() == doctest::Approx(0.0));
    CHECK(stage.held()->target.y() == doctest::Approx(0.6));
    render::Scene scene;
    stage.tool.decorate(scene);
    CHECK(scene.markers.size() == 1);
    // Along the view nothing can be moved with the pointer: it stays.
    CHECK(stage.tool.key(Qt::Key_Z, {}));
    stage.pull(stage.tool, Vec3(1.0, 1.0, 0));
    CHECK((stage.held()->target - Vec3(3, 0, 0)).norm() < 1e-9);
    stage.letGo(stage.tool, Vec3(1, 1, 0));
}

TEST_CASE("pose tool: Shift drags ten times finer, Ctrl onto the grid") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    stage.pull(stage.tool, Vec3(3, 0.5, 0), Qt::ShiftModifier);
    REQUIRE(stage.held());
    CHECK(stage.held()->target.y() == doctest::Approx(0.05));
    stage.pull(stage.tool, Vec3(2.77, 0.93, 0), Qt::ControlModifier);
    const Vec3 snapped = stage.held()->target;
    // 7 m over 800 pixels: the grid is the first power of ten over 12 pixels, 1 m.
    for (int k = 0; k < 3; ++k) CHECK(std::abs(snapped[k] - std::round(snapped[k])) < 1e-12);
    stage.letGo(stage.tool, Vec3(2.8, 0.9, 0));
}

TEST_CASE("pose tool: the wheel and R turn the end about its bone in the same step as the drag") {
    PoseStage stage;
    const int before = stage.steps();
    stage.press(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.tool.wheel(2.0, stage.at(0, 0, Qt::NoButton, Qt::LeftButton)));
    REQUIRE(stage.held());
    REQUIRE(stage.held()->roll);
    const double turned = *stage.held()->roll;
    CHECK(turned > 0.1);
    CHECK(stage.tool.key(Qt::Key_R, {}));
    const Vec3 target = stage.held()->target;
    stage.pull(stage.tool, Vec3(3.5, 0, 0));
    CHECK(*stage.held()->roll > turned);
    CHECK((stage.held()->target - target).norm() < 1e-9);
    stage.tool.keyReleased(Qt::Key_R);
    stage.pull(stage.tool, Vec3(3.5, 0.5, 0));
    CHECK((stage.held()->target - Vec3(3, 0.5, 0)).norm() < 1e-9);
    stage.letGo(stage.tool, Vec3(3.5, 0.5, 0));
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("pose tool: without a drag the wheel is left to the view") {
    PoseStage stage;
    stage.hover(stage.tool, Vec3(3, 0, 0));
    CHECK(!stage.tool.wheel(1.0, stage.at(0, 0, Qt::NoButton, Qt::NoButton)));
}

TEST_CASE("pose tool: P pins and unpins the end under the pointer, a double click lets go") {
    PoseStage stage;
    stage.hover(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.tool.wants(Qt::Key_P));
    CHECK(stage.tool.key(Qt::Key_P, {}));
    REQUIRE(stage.held());
    CHECK(stage.held()->pinned);
    CHECK(stage.tool.key(Qt::Key_P, {}));
    CHECK(!stage.held());
    stage.tool.leave();
    CHECK(!stage.tool.wants(Qt::Key_P));  // away from the ends the key is the window's
    stage.press(stage.tool, Vec3(3, 0, 0));
    stage.pull(stage.tool, Vec3(2.9, 0.4, 0));
    stage.letGo(stage.tool, Vec3(2.9, 0.4, 0));
    REQUIRE(stage.held());
    const Vec3 at = *endpointPosition(stage.session(), stage.tip);
    const auto s = stage.screen(at);
    stage.tool.doubleClick(stage.at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton));
    CHECK(!stage.held());
    CHECK(stage.refusals.empty());
}

TEST_CASE("pose tool: pulling at the body pulls at the nearest end of its bone") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(2.6, 0.4, 0));
    stage.pull(stage.tool, Vec3(2.6, 0.9, 0));
    REQUIRE(stage.held());
    CHECK((stage.held()->target - Vec3(3, 0.5, 0)).norm() < 1e-9);
    stage.letGo(stage.tool, Vec3(2.6, 0.9, 0));
}

TEST_CASE("pose tool: an end that is gone in mid-drag ends the drag without a trace") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    (void)stage.made->execute({{"do", "remove-bone"}, {"name", "bone 2"}});
    const int before = stage.steps();
    stage.pull(stage.tool, Vec3(2, 1, 0));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before);
    CHECK(stage.refusals.size() == 1);
}

TEST_CASE("pose tool: targets far out of reach stay finite") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    for (int i = 0; i < 20; ++i) stage.pull(stage.tool, Vec3(1e4 * (i % 3 - 1), 1e4 * (i % 5 - 2), 0));
    stage.letGo(stage.tool, Vec3(0, 0, 0));
    for (const Vec3& p : stage.now().pose.points) CHECK(p.allFinite());
}

namespace {

/// A bar with a handle at each end, precomputed, whose flesh is pulled by passing handles.
struct FleshStage : ToolStage {
    PoseTool tool{document()};
    FleshStage() {
        add("bar", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 24, 4, 4).mesh);
        for (const double x : {-2.5, 2.5}) run({{"do", "handle"}, {"element", "bar"}, {"point", {x, 0, 0.5}}, {"radius", 0.3}});
        run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "as-is"}});
        run({{"do", "precompute"}});
        look(ViewAxis::Front);
        tool.setOptions({[](const Element&) { return true; }});
    }
    const std::vector<Handle>& handles() { return element("bar").handles; }
    Points flesh() { return session().positionsOf(element("bar").id); }
};

}  // namespace

TEST_CASE("pose tool: flesh is pulled by a passing handle, which leaves nothing but one step") {
    FleshStage stage;
    const Document before = stage.now();
    const Points rest = stage.flesh();
    const auto response = stage.session().response(stage.element("bar").id);
    REQUIRE(response);
    const int steps = stage.steps();
    stage.hover(stage.tool, Vec3(0, 0, 0.5));
    const QString hint = stage.tool.hint();
    stage.press(stage.tool, Vec3(0, 0, 0.5));
    CHECK(stage.tool.busy());
    CHECK(stage.handles().size() == 2);  // a click makes none
    for (int i = 1; i <= 5; ++i) stage.pull(stage.tool, Vec3(0.02 * i, 0.1 * i, 0.5));
    REQUIRE(stage.handles().size() == 3);
    const FaceRef made{stage.element("bar").id, stage.handles()[2].face};
    CHECK((stage.handles()[2].point - Vec3(0, 0, 0.5)).norm() < 0.02);
    const Vec3 origin = stage.element("bar").faces[2].frame.origin;
    CHECK((stage.session().poseOf(made)->at - origin - Vec3(0.1, 0.5, 0)).norm() < 1e-6);
    CHECK(stage.tool.hint() != hint);
    stage.letGo(stage.tool, Vec3(0.1, 0.5, 0.5));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == steps + 1);
    CHECK(stage.handles() == before.elementNamed("bar")->handles);
    CHECK(stage.element("bar").faces.size() == 2);
    CHECK(stage.now().handleGoals.empty());
    CHECK(stage.session().response(made.element) == response);  // by its key: nothing was solved
    CHECK(stage.flesh() == rest);
    // A script does the same.
    const auto& script = stage.session().script();
    REQUIRE(script.size() > 6);
    CHECK(script.back()["do"] == "remove-handle");
    CHECK(std::count_if(script.begin(), script.end(), [](const Json& line) { return line["do"] == "handle"; }) == 3);
    stage.run({{"do", "undo"}});
    CHECK(stage.handles().size() == 2);
    CHECK(stage.refusals.empty());
}

TEST_CASE("pose tool: K keeps a passing handle, while it is dragged or after it went") {
    FleshStage stage;
    int steps = stage.steps();
    CHECK(!stage.tool.wants(Qt::Key_K));
    stage.press(stage.tool, Vec3(0, 0, 0.5));
    stage.pull(stage.tool, Vec3(0, 0.4, 0.5));
    CHECK(stage.tool.wants(Qt::Key_K));
    CHECK(stage.tool.key(Qt::Key_K, {}));
    stage.letGo(stage.tool, Vec3(0, 0.4, 0.5));
    REQUIRE(stage.handles().size() == 3);
    CHECK(stage.steps() == steps + 1);
    CHECK(stage.selected() == SelectionItem{Kind::Face, stage.element("bar").id, stage.handles()[2].face, false});
    stage.run({{"do", "undo"}});
    CHECK(stage.handles().size() == 2);
    CHECK(stage.now().handleGoals.empty());

    steps = stage.steps();
    stage.press(stage.tool, Vec3(0, 0, 0.5));
    stage.pull(stage.tool, Vec3(0, 0.4, 0.5));
    const Vec3 at = stage.now().handleGoals.begin()->second.target.at;
    stage.letGo(stage.tool, Vec3(0, 0.4, 0.5));
    REQUIRE(stage.handles().size() == 2);
    CHECK(stage.tool.wants(Qt::Key_K));
    CHECK(stage.tool.key(Qt::Key_K, {}));
    REQUIRE(stage.handles().size() == 3);
    CHECK(stage.steps() == steps + 2);
    CHECK(stage.now().handleGoals.begin()->second.target.at == at);
    CHECK(!stage.tool.wants(Qt::Key_K));
    CHECK(stage.refusals.empty());
}

TEST_CASE("pose tool: a passing handle takes the flesh as it lies, is cancelled without a trace, and becomes small where there is no room") {
    FleshStage stage;
    // Bent first: the end is turned by a right angle about y.
    stage.run({{"do", "drag"}, {"endpoint", "handle 2"}, {"to", {2.0, 0.0, -0.5}}, {"rotation", {0.0, std::sqrt(0.5), 0.0, std::sqrt(0.5)}}});
    stage.camera.setAxis(ViewAxis::Top, false);
    const Document before = stage.now();
    const int steps = stage.steps();
    const Points bent = stage.flesh();
    Eigen::Index top = 0;
    (stage.element("bar").mesh->body.vertices.rowwise() - Eigen::RowVector3d(1.25, 0.5, 0.0)).rowwise().norm().minCoeff(&top);
    const Vec3 there = bent.row(top).transpose();
    stage.press(stage.tool, there);
    stage.pull(stage.tool, there + Vec3(0.05, 0, 0));
    REQUIRE(stage.handles().size() == 3);
    const HandleGoal goal = stage.now().handleGoals.at({stage.element("bar").id, stage.handles()[2].face});
    CHECK(goal.target.rotation.angularDistance(Eigen::Quaterniond::Identity()) > 0.1);
    CHECK((goal.target.at - there).norm() < 0.3);
    stage.tool.cancel();
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == steps);
    CHECK(stage.handles().size() == 2);
    CHECK(stage.flesh() == bent);

    stage.run({{"do", "rest"}});
    stage.camera.setAxis(ViewAxis::Front, false);
    // Beside a disc there is no room for a second one as large.
    stage.press(stage.tool, Vec3(1.95, 0, 0.5));
    stage.pull(stage.tool, Vec3(1.95, 0.2, 0.5));
    REQUIRE(stage.tool.busy());
    if (stage.handles().size() == 3) CHECK(stage.handles()[2].radius < 0.05 * std::sqrt(38.0));
    stage.tool.cancel();
    CHECK(stage.handles().size() == 2);
    CHECK(stage.refusals.empty());
}

TEST_CASE("pose tool: where flesh is not soft in a moment, the nearest grip moves it") {
    FleshStage stage;
    stage.tool.setOptions({[](const Element&) { return false; }});
    stage.press(stage.tool, Vec3(0.5, 0, 0.5));
    stage.pull(stage.tool, Vec3(0.5, 0.3, 0.5));
    CHECK(stage.handles().size() == 2);
    CHECK(stage.now().handleGoals.size() == 1);
    stage.letGo(stage.tool, Vec3(0.5, 0.3, 0.5));
}

TEST_CASE("pose tool: typed numbers lead in the place of the pointer, axis by axis, and the drag is one step") {
    PoseStage stage;
    const int before = stage.steps();
    stage.press(stage.tool, Vec3(3, 0, 0));
    const auto type = [&](const QString& signs) {
        for (const QChar sign : signs) CHECK(stage.tool.key(sign == u'\t' ? Qt::Key_Tab : 0, {}, sign == u'\t' ? QString() : QString(sign)));
    };
    type(QStringLiteral("-20 cm\t1/2"));
    REQUIRE(stage.held());
    CHECK((stage.held()->target - Vec3(2.8, 0.5, 0)).norm() < 1e-9);
    CHECK(stage.tool.banner().contains(QStringLiteral("1/2")));
    stage.pull(stage.tool, Vec3(2.5, 0.9, 0));
    CHECK((stage.held()->target - Vec3(2.8, 0.5, 0)).norm() < 1e-9);
    // Backspace, until the pointer leads again.
    for (int i = 0; i < 3; ++i) stage.tool.key(Qt::Key_Backspace, {}, {});
    CHECK((stage.held()->target - Vec3(2.8, 0, 0)).norm() < 1e-9);
    stage.tool.key(Qt::Key_Backspace, {}, {});
    CHECK((stage.held()->target - Vec3(2.5, 0.9, 0)).norm() < 1e-9);
    CHECK(stage.tool.banner().isEmpty());
    // A number that is typed, and then an axis for it; also one that is seen end on.
    type(QStringLiteral("0.25"));
    CHECK(stage.tool.key(Qt::Key_Y, {}, QStringLiteral("y")));
    CHECK((stage.held()->target - Vec3(3, 0.25, 0)).norm() < 1e-9);
    CHECK(stage.tool.key(Qt::Key_Z, {}, QStringLiteral("z")));
    CHECK((stage.held()->target - Vec3(3, 0, 0.25)).norm() < 1e-9);
    CHECK(stage.tool.key(Qt::Key_Return, {}, {}));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 1);
    CHECK((stage.held()->target - Vec3(3, 0, 0.25)).norm() < 1e-9);
}

TEST_CASE("pose tool: Shift and an axis confine the drag to the plane across it") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.tool.key(Qt::Key_X, Qt::ShiftModifier, QStringLiteral("X")));
    render::Scene scene;
    stage.tool.decorate(scene);
    CHECK(scene.markers.size() == 2);
    CHECK(stage.tool.banner().contains(QStringLiteral("edge")));
    CHECK(stage.tool.key(0, {}, QStringLiteral("1")));
    CHECK((stage.held()->target - Vec3(3, 1, 0)).norm() < 1e-9);
    stage.tool.cancel();
    CHECK(!stage.held());
}

TEST_CASE("pose tool: an angle is typed while R is held") {
    PoseStage stage;
    stage.press(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.tool.key(Qt::Key_R, {}, QStringLiteral("r")));
    for (const QChar sign : QStringLiteral("45")) CHECK(stage.tool.key(0, {}, QString(sign)));
    stage.tool.keyReleased(Qt::Key_R);
    REQUIRE(stage.held());
    CHECK(stage.held()->roll.value_or(0.0) == doctest::Approx(std::atan(1.0)));
    CHECK(stage.tool.banner().contains(QStringLiteral("45")));
    stage.letGo(stage.tool, Vec3(3, 0, 0));
    CHECK(stage.held()->roll.value_or(0.0) == doctest::Approx(std::atan(1.0)));
}

TEST_CASE("pose tool: G moves what is selected without a button, R then turns it, a press keeps it and Esc takes it back") {
    PoseStage stage;
    stage.hover(stage.tool, Vec3(1, 1.2, 0));
    CHECK(!stage.tool.wants(Qt::Key_G));
    stage.document().select({SelectionItem{Kind::Endpoint, stage.tip.bone, {}, true}});
    CHECK(stage.tool.wants(Qt::Key_G));
    CHECK(stage.tool.wants(Qt::Key_R));
    const int before = stage.steps();
    CHECK(stage.tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    CHECK(stage.tool.modal());
    stage.hover(stage.tool, Vec3(0.8, 1.5, 0));
    REQUIRE(stage.held());
    CHECK((stage.held()->target - Vec3(2.8, 0.3, 0)).norm() < 1e-6);
    const auto at = stage.screen(Vec3(0.8, 1.5, 0));
    stage.tool.release(stage.at(at.x(), at.y(), Qt::LeftButton, Qt::NoButton));
    CHECK(stage.tool.busy());  // a release ends nothing
    stage.press(stage.tool, Vec3(0.8, 1.5, 0));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 1);
    CHECK(stage.tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    CHECK(stage.tool.key(Qt::Key_R, {}, QStringLiteral("r")));
    for (const QChar sign : QStringLiteral("30")) CHECK(stage.tool.key(0, {}, QString(sign)));
    stage.tool.keyReleased(Qt::Key_R);
    CHECK(stage.held()->roll.value_or(0.0) == doctest::Approx(std::atan(1.0) * 2.0 / 3.0));
    stage.tool.cancel();
    CHECK(stage.steps() == before + 1);
    CHECK(!stage.held()->roll);
}
