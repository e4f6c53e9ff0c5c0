// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/touch_tool.h"

#include "tests/tools/stage.h"

using namespace imomushi;

namespace {

/// One bar with a joint face at each end, looked at from the front, and what the tool offered.
struct Touching : ToolStage {
    TouchTool tool{document()};
    std::vector<Json> offers;
    Touching() {
        add("bar", shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 12, 3, 3).mesh);
        run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "tail"}, {"plane", {{"origin", {-3, 0, 0}}, {"normal", {-1, 0, 0}}}}});
        run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "tip"}, {"plane", {{"origin", {3, 0, 0}}, {"normal", {1, 0, 0}}}}});
        QObject::connect(&document(), &StudioDocument::offered, [this](const QString&, const QString&, const Json& command) { offers.push_back(command); });
        look(ViewAxis::Front);
    }
};

}  // namespace

TEST_CASE("touch tool: where the effect is off a press offers it and does not turn it on") {
    Touching stage;
    const int before = stage.steps();
    stage.click(stage.tool, Vec3(0.2, 0.1, 0.5));
    REQUIRE(stage.offers.size() == 1);
    // With finger tips of a fortieth of its length.
    REQUIRE(stage.offers[0].size() == 2);
    CHECK(stage.offers[0][0] == Json{{"do", "enable"}, {"effect", "touch"}});
    CHECK(stage.offers[0][1]["property"] == "tip");
    CHECK(stage.offers[0][1]["value"].get<double>() == doctest::Approx(6.0 / 40.0));
    CHECK(!stage.now().effects.has(EffectKind::Touch));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before);
    stage.tool.begin();
    CHECK(stage.offers.size() == 2);
}

TEST_CASE("touch tool: beside the bodies there is nothing to touch or to offer") {
    Touching stage;
    stage.click(stage.tool, Vec3(0.0, 2.0, 0.5));
    CHECK(stage.offers.empty());
    CHECK(!stage.tool.busy());
}

TEST_CASE("touch tool: G puts a finger down without a button, Enter or a click lifts it as one step, and Esc takes it back") {
    Touching stage;
    stage.run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "draft"}});
    stage.run({{"do", "enable"}, {"effect", "touch"}});
    stage.run({{"do", "precompute"}});
    const int before = stage.steps();
    CHECK(!stage.tool.key(Qt::Key_G, Qt::NoModifier));
    stage.hover(stage.tool, Vec3(0.2, 0.1, 0.5));
    CHECK(stage.tool.wants(Qt::Key_G));
    CHECK(stage.tool.key(Qt::Key_G, Qt::NoModifier));
    CHECK(stage.offers.empty());
    REQUIRE(stage.tool.modal());
    CHECK(stage.now().touches.size() == 1);
    stage.hover(stage.tool, Vec3(0.6, 0.1, 0.5));
    CHECK(stage.now().touches[0].to.x() == doctest::Approx(0.6).epsilon(0.02));
    CHECK(stage.tool.key(Qt::Key_Return, Qt::NoModifier));
    CHECK(!stage.tool.busy());
    CHECK(stage.now().touches.empty());
    CHECK(stage.steps() == before + 1);
    stage.hover(stage.tool, Vec3(0.2, 0.1, 0.5));
    stage.tool.key(Qt::Key_G, Qt::NoModifier);
    stage.click(stage.tool, Vec3(0.4, 0.1, 0.5));
    CHECK(!stage.tool.busy());
    CHECK(stage.steps() == before + 2);
    stage.hover(stage.tool, Vec3(0.2, 0.1, 0.5));
    stage.tool.key(Qt::Key_G, Qt::NoModifier);
    stage.tool.cancel();
    CHECK(stage.now().touches.empty());
    CHECK(stage.steps() == before + 2);
}

TEST_CASE("touch tool: a pen pushes flesh from not at all to twice as far as the mouse, and a typed depth is as deep as it says") {
    Touching stage;
    stage.run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "draft"}});
    stage.run({{"do", "enable"}, {"effect", "touch"}});
    stage.run({{"do", "precompute"}});
    const auto pen = [&](const Vec3& p, double pressure) {
        const auto s = stage.screen(p);
        PointerEvent e = stage.at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton);
        e.pressure = pressure;
        return e;
    };
    const Vec3 at(0.2, 0.1, 0.5), aside(0.5, 0.1, 0.5);
    const auto push = [&] { return Vec3(stage.now().touches.at(0).to - at); };
    stage.press(stage.tool, at);
    const Vec3 byMouse = push();
    CHECK(byMouse.z() < -1e-3);
    stage.tool.cancel();
    stage.tool.press(pen(at, 0.0));
    CHECK(push().norm() < 1e-9);
    stage.tool.move(pen(at, 0.5));
    CHECK((push() - byMouse).norm() < 1e-9);
    stage.tool.move(pen(at, 1.0));
    CHECK((push() - 2.0 * byMouse).norm() < 1e-9);
    stage.tool.move(pen(aside, 0.5));
    CHECK(push().x() == doctest::Approx(0.3));
    stage.tool.move(pen(aside, 0.25));
    CHECK(push().x() == doctest::Approx(0.15));
    CHECK(push().z() == doctest::Approx(0.5 * byMouse.z()));
    for (const char* key : {"0", ".", "2"}) stage.tool.key(Qt::Key_0, {}, QString::fromLatin1(key));
    CHECK(push().z() == doctest::Approx(-0.2));
    stage.tool.release(pen(aside, 0.25));
    CHECK(stage.now().touches.empty());
}
