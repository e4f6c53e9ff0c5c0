// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

const Vec3 kMiddle(0.0, 0.0, 3.0), kTip(0.0, 0.0, 6.0);  // of the chain of two bars, at rest

Vec3 place(Workbench& w, const char* endpoint, const Vec3& atRest) {
    const auto& pose = w.session.shownPose();
    if (pose.points.empty()) return atRest;
    return pose.points[static_cast<std::size_t>(w.session.pointIndex(*w.session.document().endpoint(endpoint)))];
}
Vec3 middle(Workbench& w) { return place(w, "a/end", kMiddle); }
Vec3 tip(Workbench& w) { return place(w, "b/end", kTip); }

Json enable(const char* effect) { return {{"do", "enable"}, {"effect", effect}}; }
Json set(const char* effect, const char* property, const Json& value) {
    return {{"do", "set"}, {"target", effect}, {"property", property}, {"value", value}};
}

}  // namespace

TEST_CASE("effects: names, targets and settings are checked, and each answer says what is wrong") {
    Workbench w;
    w.buildChain();
    CHECK(w.code(enable("wind")) == "no-such-effect");
    CHECK(w.code({{"do", "enable"}, {"effect", "bone-dynamics"}, {"target", "Z"}}) == "no-such-element");
    CHECK(w.code({{"do", "enable"}, {"effect", "bone-dynamics"}, {"target", "A"}}) == "bad-target");
    CHECK(w.code({{"do", "disable"}, {"effect", "bone-dynamics"}}) == "not-enabled");
    for (std::size_t k = 0; k < kEffects; ++k)
        for (const auto& p : effectProperties(static_cast<EffectKind>(k))) {
            const std::string effect(kEffectNames[k]), property(p.name);
            const auto value = [&](double x) { return p.size == 3 ? Json{x, 0.0, p.low} : Json(x); };
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.high))) == "ok");
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.high * 1.01 + 1e-9))) == "bad-value");
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.low - std::abs(p.low) * 0.01 - 1e-9))) == "bad-value");
            CHECK(w.code(set(effect.c_str(), property.c_str(), "much")) == "bad-type");
        }
    CHECK(w.code(set("gravity", "colour", 1)) == "no-such-property");
    CHECK(w.code(set("smooth-joints", "colour", 1)) == "no-such-property");
    for (const auto name : kEffectNames) CHECK(w.code({{"do", "rename"}, {"target", "A"}, {"name", std::string(name)}}) == "bad-name");
}

TEST_CASE("effects: enabling, settings and disabling are steps that undo and redo take back and forth, and a project keeps them") {
    Workbench w;
    w.buildChain();
    const std::string before = w.content();
    w.good(enable("bone-dynamics"));
    w.good(set("bone-dynamics", "swing-hertz", 7.5));
    w.good(set("ground", "height", -2.0));
    const std::string after = w.content();
    CHECK(w.good({{"do", "list"}})["effects"] == Json{"bone-dynamics"});
    w.good({{"do", "undo"}, {"count", 3}});
    CHECK(w.content() == before);
    w.good({{"do", "redo"}, {"count", 3}});
    CHECK(w.content() == after);
    const auto path = (Workbench::folder() / "effects.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    const Json opened = other.good({{"do", "open"}, {"path", path}});
    CHECK(opened["effects"] == Json{"bone-dynamics"});
    CHECK(other.content() == after);
    CHECK(other.session.document().effects.number(EffectKind::BoneDynamics, "swing-hertz") == 7.5);
    other.good({{"do", "disable"}, {"effect", "bone-dynamics"}});
    CHECK(other.good({{"do", "list"}})["effects"] == Json::array());
}

TEST_CASE("effects: without any, a scene is performed to the bit as if there were no effects") {
    const auto perform = [](bool touched) {
        Workbench w;
        w.buildChain();
        w.good({{"do", "precompute"}});
        if (touched) {
            w.good(enable("bone-dynamics"));
            w.good(enable("ground"));
            w.good({{"do", "step"}, {"frames", 10}});
            w.good({{"do", "disable"}, {"effect", "ground"}});
            w.good({{"do", "disable"}, {"effect", "bone-dynamics"}});
            w.good({{"do", "rest"}});
        }
        w.good({{"do", "pin"}, {"endpoint", "a/start"}});
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 0.5, 5.0}}, {"seconds", 0.2}});
        const Json answer = w.good({{"do", "step"}, {"frames", 20}});
        CHECK(answer["effects"] == Json::object());
        const auto path = (Workbench::folder() / "without.obj").string();
        w.good({{"do", "write-mesh"}, {"path", path}, {"state", "current"}});
        return Workbench::readFile(path);
    };
    CHECK(perform(false) == perform(true));
}

TEST_CASE("bone dynamics: a dragged body follows through, its row is in the statistics, and it comes to rest on the target") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    CHECK(w.good(enable("bone-dynamics"))["ms_per_frame"].get<double>() > 0.0);
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    const Vec3 target(1.5, 0.0, 5.5);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.0, 5.5}}});
    CHECK((tip(w) - kTip).norm() < 1e-12);  // nothing moves before a frame does
    CHECK(w.session.moving());
    const Json first = w.good({{"do", "step"}, {"frames", 30}});
    CHECK(first["effects"].contains("bone-dynamics"));
    CHECK(first["finite"] == true);
    w.good({{"do", "step"}, {"frames", 600}});
    CHECK((tip(w) - target).norm() < 1e-3);
    CHECK_FALSE(w.session.moving());

    w.good({{"do", "release"}});
    CHECK((tip(w) - target).norm() < 1e-3);
    CHECK(w.session.moving());
    w.good({{"do", "step"}, {"frames", 5}});
    CHECK((tip(w) - target).norm() > 1e-2);
    CHECK((tip(w) - kTip).norm() > 1e-2);
    w.good({{"do", "step"}, {"frames", 1200}});
    CHECK((tip(w) - kTip).norm() < 1e-4);
    CHECK_FALSE(w.session.moving());
}

TEST_CASE("bone dynamics: rest and undo stop at once, and settings change while it swings") {
    Workbench w;
    w.buildChain();
    w.good(enable("bone-dynamics"));
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.0, 4.0}}});
    w.good({{"do", "step"}, {"frames", 10}});
    const Vec3 swinging = middle(w);
    CHECK((swinging - kMiddle).norm() > 0.01);
    w.good(set("bone-dynamics", "swing-damping", 1.0));
    CHECK((middle(w) - swinging).norm() == 0.0);
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK((middle(w) - swinging).norm() > 0.0);
    CHECK((middle(w) - swinging).norm() < 0.5);
    w.good({{"do", "rest"}});
    CHECK((tip(w) - kTip).norm() < 1e-12);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.0, 4.0}}});
    w.good({{"do", "step"}, {"frames", 10}});
    w.good({{"do", "undo"}});
    CHECK((tip(w) - kTip).norm() < 1e-12);
}

TEST_CASE("ground: what is held is lifted out of it, and what floats falls on it and lies still on its flesh") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const double radius = std::sqrt(0.5);  // of the bars' square faces
    w.good(set("ground", "height", -1.0));
    w.good(enable("ground"));
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, -4.0, 4.0}}});
    CHECK(tip(w).y() == doctest::Approx(-1.0 + radius).epsilon(1e-9));
    CHECK(w.good({{"do", "step"}, {"frames", 3}})["effects"].contains("ground"));
    w.good({{"do", "rest"}});
    w.good({{"do", "unpin"}, {"endpoint", "a/start"}});

    w.good(set("ground", "height", -3.0));
    w.good(enable("bone-dynamics"));
    w.good(set("gravity", "acceleration", {0.0, -9.81, 0.0}));
    w.good(enable("gravity"));
    w.good({{"do", "step"}, {"frames", 30}});
    CHECK(tip(w).y() < -0.5);
    const Json answer = w.good({{"do", "step"}, {"frames", 600}});
    CHECK(answer["finite"] == true);
    CHECK(tip(w).y() == doctest::Approx(-3.0 + radius).epsilon(1e-6));
    CHECK_FALSE(w.session.moving());
}
