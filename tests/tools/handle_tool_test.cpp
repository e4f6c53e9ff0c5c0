// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/handle_tool.h"

#include <cmath>

#include "tests/tools/stage.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

/// A bar along x, from -3 to 3, looked at from its front.
struct HandleStage : ToolStage {
    HandleTool tool{document()};
    HandleStage() {
        add("bar", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 24, 4, 4).mesh);
        look(ViewAxis::Front);
    }
    /// Those that were placed: the first one on a body brings others that hold it.
    std::vector<Handle> handles() {
        std::vector<Handle> placed = element("bar").handles;
        std::erase_if(placed, [](const Handle& h) { return !h.face.starts_with("handle "); });
        return placed;
    }
    const HandleGoal* goal(const std::string& name) {
        const auto found = now().handleGoals.find({element("bar").id, name});
        return found == now().handleGoals.end() ? nullptr : &found->second;
    }
};

}  // namespace

TEST_CASE("handle tool: a press makes a handle and drags it at once, as two steps") {
    HandleStage stage;
    const int before = stage.steps();
    stage.hover(stage.tool, Vec3(2.5, 0, 0.5));
    render::Scene scene;
    stage.tool.decorate(scene);
    CHECK(!scene.markers.empty());  // what a press would make
    stage.press(stage.tool, Vec3(2.5, 0, 0.5));
    REQUIRE(stage.handles().size() == 1);
    CHECK(stage.handles()[0].face == "handle 1");
    CHECK((stage.handles()[0].point - Vec3(2.5, 0, 0.5)).norm() < 0.02);
    CHECK(stage.tool.busy());
    CHECK(stage.selected() == SelectionItem{Kind::Face, stage.element("bar").id, "handle 1", false});
    const Vec3 origin = stage.element("bar").faces[0].frame.origin;
    for (int i = 1; i <= 5; ++i) stage.pull(stage.tool, Vec3(2.5, 0.1 * i, 0.5));
    stage.letGo(stage.tool, Vec3(2.5, 0.5, 0.5));
    CHECK(!stage.tool.busy());
    REQUIRE(stage.goal("handle 1"));
    CHECK((stage.goal("handle 1")->target.at - (origin + Vec3(0, 0.5, 0))).norm() < 1e-6);
    CHECK(stage.steps() == before + 2);
    stage.run({{"do", "undo"}, {"count", 2}});
    CHECK(stage.handles().empty());
}

TEST_CASE("handle tool: a press on a handle that is there drags it, P pins it, Delete removes it") {
    HandleStage stage;
    stage.click(stage.tool, Vec3(-2.5, 0, 0.5));
    stage.click(stage.tool, Vec3(2.5, 0, 0.5));
    REQUIRE(stage.handles().size() == 2);
    stage.press(stage.tool, Vec3(2.5, 0, 0.5));
    stage.pull(stage.tool, Vec3(2.5, 0.3, 0.5));
    stage.letGo(stage.tool, Vec3(2.5, 0.3, 0.5));
    CHECK(stage.handles().size() == 2);
    REQUIRE(stage.goal("handle 2"));
    stage.hover(stage.tool, stage.goal("handle 2")->target.at);
    CHECK(stage.tool.wants(Qt::Key_P));
    CHECK(stage.tool.key(Qt::Key_P, {}));
    CHECK(stage.goal("handle 2")->pinned);
    CHECK(stage.tool.key(Qt::Key_Delete, {}));
    CHECK(stage.handles().size() == 1);
}

TEST_CASE("handle tool: the brush makes larger and smaller discs") {
    HandleStage stage;
    stage.hover(stage.tool, Vec3(0, 0, 0.5));
    for (int i = 0; i < 4; ++i) CHECK(stage.tool.key(Qt::Key_BracketRight, {}));
    stage.click(stage.tool, Vec3(0, 0, 0.5));
    REQUIRE(stage.handles().size() == 1);
    const double large = stage.handles()[0].radius;
    CHECK(stage.tool.wheel(-1.0, stage.at(0, 0, Qt::NoButton, {}, Qt::ControlModifier)));
    CHECK(!stage.tool.wheel(-1.0, stage.at(0, 0, Qt::NoButton, {}, {})));
    stage.click(stage.tool, Vec3(2.2, 0, 0.5));
    REQUIRE(stage.handles().size() == 2);
    CHECK(stage.handles()[1].radius == doctest::Approx(large / 1.2));
    CHECK(stage.element("bar").faces[0].area > stage.element("bar").faces[1].area);
}

TEST_CASE("handle tool: what is refused is said, and nothing is made") {
    HandleStage stage;
    stage.click(stage.tool, Vec3(0, 0, 0.5));
    REQUIRE(stage.handles().size() == 1);
    const double edge = stage.element("bar").faces[0].size;
    stage.click(stage.tool, Vec3(1.2 * edge, 0, 0.5));
    CHECK(stage.handles().size() == 1);
    CHECK(stage.refusals.size() == 1);
    stage.press(stage.tool, Vec3(20, 20, 0));
    CHECK(stage.handles().size() == 1);
    CHECK(!stage.tool.busy());
}

TEST_CASE("handle tool: R and a drag turn the handle, X about one axis; Esc takes the drag back") {
    HandleStage stage;
    stage.click(stage.tool, Vec3(2.5, 0, 0.5));
    stage.press(stage.tool, Vec3(2.5, 0, 0.5));
    CHECK(stage.tool.key(Qt::Key_R, {}));
    CHECK(stage.tool.key(Qt::Key_X, {}));
    stage.pull(stage.tool, Vec3(3.0, 0.2, 0.5));
    REQUIRE(stage.goal("handle 1"));
    const Eigen::Quaterniond turn = stage.goal("handle 1")->target.rotation;
    CHECK(turn.vec().norm() > 0.01);
    CHECK(turn.vec().tail<2>().norm() < 1e-12);
    CHECK((stage.goal("handle 1")->target.at - stage.element("bar").faces[0].frame.origin).norm() < 1e-9);
    stage.tool.cancel();
    CHECK(!stage.goal("handle 1"));
}

TEST_CASE("pose tool: flesh that is taken anywhere moves the handle nearest to it") {
    HandleStage stage;
    stage.click(stage.tool, Vec3(-2.5, 0, 0.5));
    stage.click(stage.tool, Vec3(2.5, 0, 0.5));
    PoseTool pose(stage.document());
    stage.press(pose, Vec3(1.0, 0, 0.5));
    stage.pull(pose, Vec3(1.0, 0.4, 0.5));
    stage.letGo(pose, Vec3(1.0, 0.4, 0.5));
    CHECK(stage.goal("handle 2"));
    CHECK(!stage.goal("handle 1"));
}

TEST_CASE("handle tool: G moves the selected handle over the surface and S sets its radius, each in one step") {
    HandleStage stage;
    stage.click(stage.tool, Vec3(2.0, 0, 0.5));
    REQUIRE(stage.handles().size() == 1);
    const double radius = stage.handles()[0].radius;
    const int before = stage.steps();
    stage.hover(stage.tool, Vec3(2.0, 1.4, 0.5));
    CHECK(stage.tool.wants(Qt::Key_G));
    CHECK(stage.tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    CHECK(stage.tool.modal());
    stage.hover(stage.tool, Vec3(1.2, 0.1, 0.5));
    render::Scene scene;
    stage.tool.decorate(scene);
    CHECK_MESSAGE(!scene.markers.empty(), stage.tool.hint().toStdString());
    CHECK(stage.steps() == before);
    stage.press(stage.tool, Vec3(1.2, 0.1, 0.5));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 1);
    CHECK((stage.handles()[0].point - Vec3(1.2, 0.1, 0.5)).norm() < 1e-6);
    CHECK(stage.handles()[0].radius == doctest::Approx(radius));
    CHECK(stage.refusals.empty());
    CHECK(stage.tool.key(Qt::Key_S, {}, QStringLiteral("s")));
    for (const QChar sign : QStringLiteral("150%")) CHECK(stage.tool.key(0, {}, QString(sign)));
    CHECK(stage.tool.banner().contains(QStringLiteral("150%")));
    CHECK(stage.tool.key(Qt::Key_Return, {}, {}));
    CHECK(stage.handles()[0].radius == doctest::Approx(1.5 * radius));
    CHECK(stage.steps() == before + 2);
    CHECK(stage.tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    stage.hover(stage.tool, Vec3(-1, 0.1, 0.5));
    stage.tool.cancel();
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 2);
    stage.run({{"do", "undo"}, {"count", 2}});
    CHECK(stage.handles()[0].radius == doctest::Approx(radius));
    CHECK((stage.handles()[0].point - Vec3(2.0, 0, 0.5)).norm() < 0.02);
}
