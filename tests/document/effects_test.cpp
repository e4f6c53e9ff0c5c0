// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

TEST_CASE("effects: an empty document has none that moves") {
    Workbench w;
    CHECK_FALSE(w.session.moving());
    w.good(enable("bone-dynamics"));
    w.good(enable("inflate"));
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK_FALSE(w.session.moving());
    CHECK(w.session.shownPose().points.empty());
}

TEST_CASE("effects: names, targets and settings are checked, and each answer says what is wrong") {
    Workbench w;
    w.buildChain();
    CHECK(w.code(enable("wind")) == "no-such-effect");
    CHECK(w.code({{"do", "enable"}, {"effect", "bone-dynamics"}, {"target", "Z"}}) == "no-such-element");
    CHECK(w.code({{"do", "enable"}, {"effect", "bone-dynamics"}, {"target", "A"}}) == "bad-target");
    CHECK(w.code({{"do", "disable"}, {"effect", "bone-dynamics"}}) == "not-enabled");
    for (std::size_t k = 0; k < kEffects; ++k)
        for (const auto& p : effectProperties(static_cast<EffectKind>(k))) {
            const std::string effect(effectName(static_cast<EffectKind>(k))), property(p.name);
            const auto value = [&](double x) { return p.size == 3 ? Json{x, 0.0, p.low} : Json(x); };
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.high))) == "ok");
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.high * 1.01 + 1e-9))) == "bad-value");
            CHECK(w.code(set(effect.c_str(), property.c_str(), value(p.low - std::abs(p.low) * 0.01 - 1e-9))) == "bad-value");
            CHECK(w.code(set(effect.c_str(), property.c_str(), "much")) == "bad-type");
        }
    CHECK(w.code(set("gravity", "colour", 1)) == "no-such-property");
    CHECK(w.code(set("smooth-joints", "colour", 1)) == "no-such-property");
    for (std::size_t k = 0; k < kEffects; ++k)
        CHECK(w.code({{"do", "rename"}, {"target", "A"}, {"name", std::string(effectName(static_cast<EffectKind>(k)))}}) == "bad-name");
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
        return readFile(path);
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

TEST_CASE("bone dynamics: a body that nothing holds any more comes back, and all is still at any frame rate") {
    for (const double hertz : {60.0, 144.0}) {
        Workbench w;
        w.buildChain();
        w.good(enable("bone-dynamics"));
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.5, 0.0, 5.5}}});
        w.good({{"do", "step"}, {"frames", 10 * hertz}, {"dt", 1.0 / hertz}});
        CHECK_FALSE(w.session.moving());
        w.good({{"do", "release"}});
        w.good({{"do", "step"}, {"frames", 10 * hertz}, {"dt", 1.0 / hertz}});
        CHECK((tip(w) - kTip).norm() < 1e-4);
        CHECK_FALSE(w.session.moving());
    }
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
    const auto lowest = [&] {
        double found = 1e30;
        for (int e = 0; e < 2; ++e) {
            const auto surface = w.session.character()->surface(e);
            for (int i = 0; i < surface.vertices; ++i) found = std::min(found, static_cast<double>(surface.positions[3 * i + 1]));
        }
        return found;
    };
    w.good(set("ground", "height", -1.0));
    w.good(enable("ground"));
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, -4.0, 4.0}}});
    CHECK(lowest() > -1.0 - 1e-3);  // bars are 1 m wide
    CHECK(tip(w).y() > -1.0 + 0.3);
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
    CHECK(lowest() == doctest::Approx(-3.0).epsilon(1e-4));
    CHECK_FALSE(w.session.moving());
}

TEST_CASE("gravity: flesh sags down wherever down is, more where it is softer, and needs no precompute of its own") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const Json cost = w.good(enable("gravity"));
    CHECK(cost["precompute"] == false);
    CHECK(cost["columns"] == 6);
    CHECK(cost["bytes"].get<std::int64_t>() > 0);
    CHECK(w.session.responseState(w.session.document().elementNamed("A")->id) == Session::ResponseState::Fresh);
    const auto middleOfA = [&] {
        const int e = w.session.elementIndex(w.session.document().elementNamed("A")->id);
        return Vec3(w.session.character()->positions(e).colwise().mean().transpose());
    };
    const Vec3 atRest(0.0, 0.0, 1.5);
    const auto sag = [&](const Vec3& g) {
        w.good(set("gravity", "acceleration", {g.x(), g.y(), g.z()}));
        w.good({{"do", "step"}, {"frames", 1}});
        return Vec3(middleOfA() - atRest);
    };
    w.good(set("gravity", "shear-modulus", 1e6));
    const Vec3 down = sag({0.0, -9.81, 0.0});
    CHECK(down.y() < -1e-4);
    CHECK(std::abs(down.x()) < 1e-3 * std::abs(down.y()));
    CHECK((sag({0.0, 9.81, 0.0}) + down).norm() < 1e-9);
    CHECK(sag({9.81, 0.0, 0.0}).x() == doctest::Approx(-down.y()).epsilon(0.02));  // square bars
    CHECK(sag({0.0, 0.0, 0.0}).norm() < 1e-12);
    // Twice as soft sags twice as far, until flesh would fold.
    w.good(set("gravity", "shear-modulus", 5e5));
    CHECK(sag({0.0, -9.81, 0.0}).y() == doctest::Approx(2.0 * down.y()).epsilon(0.05));
    w.good(set("gravity", "shear-modulus", 1.0));
    const Json bounded = w.good({{"do", "step"}, {"frames", 1}});
    CHECK(bounded["warnings"].dump().find("shear-modulus") != std::string::npos);
    CHECK(bounded["effects"].contains("gravity"));
    CHECK(std::abs(sag({0.0, -9.81, 0.0}).y()) < 0.3 * std::sqrt(11.0));
}

TEST_CASE("gravity and pressure: they come and go without a precompute, and wait for one where a result of old has no columns for them") {
    Workbench w;
    w.buildChain();
    const PartId a = w.session.document().elementNamed("A")->id, b = w.session.document().elementNamed("B")->id;
    // As projects of old hold them.
    for (const PartId id : {a, b}) {
        ResponseInput input = w.session.responseInput(id);
        input.loads = BodyLoads::None;
        w.session.responses().bring(id, {responseKey(input), w.session.responses().shapeOf(id), std::make_shared<const ElementResponse>(buildResponse(input, {}).value())});
    }
    const auto bothAre = [&](Session::ResponseState state) { return w.session.responseState(a) == state && w.session.responseState(b) == state; };
    using enum Session::ResponseState;
    CHECK(bothAre(Fresh));
    CHECK(w.session.effectCost(EffectKind::Gravity).precompute);
    w.good(enable("gravity"));
    CHECK(bothAre(Stale));
    w.good({{"do", "precompute"}});
    CHECK(bothAre(Fresh));
    const std::size_t known = w.session.responses().store().count();
    for (const char* effect : {"gravity", "inflate"}) {
        w.good({{"do", "disable"}, {"effect", "gravity"}});
        CHECK(bothAre(Fresh));
        CHECK_FALSE(w.session.effectCost(EffectKind::Inflate).precompute);
        w.good(enable(effect));
        CHECK(bothAre(Fresh));
    }
    CHECK(w.session.responses().store().count() == known);
}

TEST_CASE("gravity: flesh feels the acceleration of its own bones and comes back to rest") {
    Workbench w;
    w.buildChain();
    w.good(enable("gravity"));
    w.good(set("gravity", "acceleration", {0.0, 0.0, 0.0}));
    w.good(set("gravity", "shear-modulus", 1e5));
    w.good({{"do", "precompute"}});
    w.good({{"do", "step"}, {"frames", 2}});
    CHECK_FALSE(w.session.moving());
    // The whole chain is moved along: nothing but inertia deforms it.
    for (const char* end : {"a/start", "a/end", "b/end"}) {
        const double z = end[0] == 'b' ? 6.0 : end[2] == 's' ? 0.0 : 3.0;
        w.good({{"do", "drag"}, {"endpoint", end}, {"to", {2.0, 0.0, z}}, {"seconds", 0.25}});
    }
    const int e = w.session.elementIndex(w.session.document().elementNamed("A")->id);
    const auto lag = [&] {
        const auto frame = w.session.character()->frame(e);
        const Vec3 mean = w.session.character()->positions(e).colwise().mean().transpose();
        return (mean - frame * Vec3(0.0, 0.0, 1.5)).x();
    };
    double behind = 0.0, ahead = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
        w.good({{"do", "step"}, {"frames", 1}});
        behind = std::min(behind, lag());
        ahead = std::max(ahead, lag());
    }
    CHECK(behind < -1e-3);  // it starts
    CHECK(ahead > 1e-3);    // it stops
    CHECK(std::abs(lag()) < 1e-6);
    CHECK_FALSE(w.session.moving());
}

TEST_CASE("end-stretch: flesh at the free end of a bone goes where the end goes, longer and shorter, and costs columns of that element alone") {
    Workbench w;
    w.buildFreeEnd();
    w.good(enable("gravity"));  // a bar that hangs on one end gets columns of loads only where they are asked for
    w.good({{"do", "precompute"}});
    w.good({{"do", "disable"}, {"effect", "gravity"}});
    for (const char* pinned : {"a/start", "a/end"}) w.good({{"do", "pin"}, {"endpoint", pinned}});
    const auto element = [&](const char* name) { return w.session.elementIndex(w.session.document().elementNamed(name)->id); };
    // The middle of the end of the bar, past what is pinned; the highest place of it.
    const auto tipOf = [&] {
        const Points at = w.session.character()->positions(element("B"));
        return at.col(2).maxCoeff();
    };
    const auto pulledTo = [&](double z) {
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, 0.0, z}}});
        return tipOf();
    };
    CHECK(pulledTo(7.0) == doctest::Approx(6.0).epsilon(1e-6));  // without it, the end leaves the flesh
    w.good({{"do", "rest"}});
    w.good(enable("end-stretch"));
    CHECK(w.session.responseState(w.session.document().elementNamed("B")->id) == Session::ResponseState::Fresh);
    CHECK(w.session.character()->loadColumns(element("A")).empty());
    CHECK(w.session.character()->loadColumns(element("B")).size() == 3);
    CHECK(tipOf() == doctest::Approx(6.0).epsilon(1e-6));
    // 2.4 tanh(1 / 2.4) = .945 and 1.2 tanh(.6 / 1.2) = .555 of the mean around the end: within a tenth for its highest place.
    CHECK(std::abs(pulledTo(7.0) - 6.945) < 0.1);
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"].get<double>() == 0.0);
    CHECK(std::abs(pulledTo(5.4) - 5.445) < 0.1);
    // Pulled aside it turns with its bone and is as long as that.
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.4, 0.0, 5.4}}});
    const Points at = w.session.character()->positions(element("B"));
    const Vec3 along = Vec3(2.4, 0.0, 2.4).normalized();
    CHECK(std::abs(((at.rowwise() - Eigen::RowVector3d(0, 0, 3)) * along).maxCoeff() - 3.39) < 0.1);
    w.good({{"do", "rest"}});
    CHECK(tipOf() == doctest::Approx(6.0).epsilon(1e-6));
    CHECK_FALSE(w.session.moving());
}

TEST_CASE("inflate: a body puffs up by its pressure, and breathes until it is turned off") {
    Workbench w;
    w.buildChain();
    w.good(enable("inflate"));
    w.good({{"do", "precompute"}});
    const auto volume = [&] { return w.good({{"do", "measure"}, {"element", "B"}, {"what", "volume"}})["value"].get<double>(); };
    const auto at = [&](double pressure) {
        w.good(set("inflate", "pressure", pressure));
        w.good({{"do", "step"}, {"frames", 1}});
        return volume() - 3.0;
    };
    const double more = at(0.05);
    CHECK(more > 0.01);
    CHECK(at(-0.05) == doctest::Approx(-more).epsilon(0.1));
    CHECK(std::abs(at(0.0)) < 1e-9);
    CHECK_FALSE(w.session.moving());
    w.good(set("inflate", "breath", 0.05));
    w.good(set("inflate", "breath-hertz", 1.0));
    double least = 3.0, most = 3.0;
    for (int frame = 0; frame < 60; ++frame) {
        CHECK(w.session.moving());
        w.good({{"do", "step"}, {"frames", 1}});
        least = std::min(least, volume());
        most = std::max(most, volume());
    }
    CHECK(most - 3.0 == doctest::Approx(more).epsilon(0.02));
    CHECK(least < 3.0 - 0.8 * more);
    CHECK(std::abs(volume() - 3.0) < 1e-6);
}

TEST_CASE("touch: with a tip the dent is finer, at once, and gone without a trace") {
    Workbench w;
    w.buildChain("default");
    w.good({{"do", "enable"}, {"effect", "touch"}});
    w.good({{"do", "precompute"}});
    const Json side = {0.5, 0.0, 1.5}, in = {0.45, 0.0, 1.5};
    const auto moved = [&] {
        const auto& part = *w.session.document().elementNamed("A");
        return Points(w.session.character()->positions(w.session.elementIndex(part.id)) - part.mesh->body.vertices);
    };
    const auto press = [&] {
        w.good({{"do", "touch"}, {"element", "A"}, {"point", side}, {"to", in}});
        return moved();
    };
    const Points coarse = press();
    w.good({{"do", "rest"}});
    CHECK(w.code({{"do", "set"}, {"target", "touch"}, {"property", "tip"}, {"value", -1}}) == "bad-value");
    w.good({{"do", "set"}, {"target", "touch"}, {"property", "tip"}, {"value", 0.05}});
    const Points fine = press();  // the precompute stays
    CHECK(fine.rowwise().norm().maxCoeff() == doctest::Approx(coarse.rowwise().norm().maxCoeff()).epsilon(0.1));
    CHECK(fine.norm() < 0.95 * coarse.norm());  // as fine as the vertices of this bar can say
    CHECK(press() == fine);
    w.good({{"do", "set"}, {"target", "touch"}, {"property", "tip"}, {"value", 0}});
    CHECK(press() == coarse);
}

TEST_CASE("touch: fingers press, never pull, are taken back by undo, and their dents go when they lift") {
    Workbench w;
    w.buildChain("default");
    const Json side = {0.5, 0.0, 1.5}, in = {0.4, 0.0, 1.5}, out = {0.7, 0.0, 1.5};
    const auto touch = [](const Json& point, const Json& to) { return Json{{"do", "touch"}, {"element", "A"}, {"point", point}, {"to", to}}; };
    CHECK(w.code(touch(side, in)) == "not-enabled");
    CHECK(w.good({{"do", "enable"}, {"effect", "touch"}, {"target", "A"}})["columns"].get<int>() > 0);
    CHECK(w.code(touch(side, in)) == "not-precomputed");
    w.good({{"do", "precompute"}});
    CHECK(w.code(touch(side, "in")) == "bad-type");
    CHECK(w.code(touch(side, nullptr)) == "not-touched");
    CHECK(w.code({{"do", "touch"}, {"element", "B"}, {"point", side}, {"to", in}}) == "not-enabled");
    const auto volume = [&] { return w.good({{"do", "measure"}, {"element", "A"}, {"what", "volume"}})["value"].get<double>(); };
    const auto dent = [&] {
        const int e = w.session.elementIndex(w.session.document().elementNamed("A")->id);
        const Points now = w.session.character()->positions(e);
        const Points& rest = w.session.document().elementNamed("A")->mesh->body.vertices;
        return (now - rest).rowwise().norm().maxCoeff();
    };
    CHECK(w.good(touch(side, in))["finger"] == 0);
    const double deep = dent();
    CHECK(deep > 0.05);
    CHECK(deep < 0.12);
    CHECK(std::abs(volume() - 3.0) < 0.03);  // flesh goes aside
    CHECK(w.good(touch({-0.5, 0.0, 1.5}, {-0.4, 0.0, 1.5}))["finger"] == 1);
    w.good({{"do", "undo"}});
    CHECK(w.session.document().touches.size() == 1);
    const Json stepped = w.good({{"do", "step"}, {"frames", 60}});
    CHECK(stepped["effects"].contains("touch"));
    CHECK(dent() == doctest::Approx(deep).epsilon(1e-3));

    w.good(touch(side, nullptr));
    double last = dent();
    CHECK(last > 0.5 * deep);  // not at once
    for (int frame = 0; frame < 60; ++frame) {
        w.good({{"do", "step"}, {"frames", 1}});
        CHECK(dent() <= last + 1e-9);
        last = dent();
    }
    CHECK(last < 1e-5);
    w.good(touch(side, out));
    w.good({{"do", "step"}, {"frames", 30}});
    CHECK(dent() < 1e-6);
    w.good({{"do", "rest"}});
    CHECK(w.session.document().touches.empty());
    w.good({{"do", "step"}, {"frames", 60}});
    CHECK_FALSE(w.session.moving());
}

TEST_CASE("joint dynamics: flesh at a joint lags behind a quick turn, jiggles and comes to rest, at any frame rate the same") {
    const auto perform = [](double hertz) {
        Workbench w;
        w.buildChain();
        w.good({{"do", "precompute"}});
        w.good(enable("joint-dynamics"));
        w.good({{"do", "pin"}, {"endpoint", "a/start"}});
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 0.0, 5.6}}, {"seconds", 0.2}});
        const int frames = static_cast<int>(0.4 * hertz);
        const Json answer = w.good({{"do", "step"}, {"frames", frames}, {"dt", 0.4 / frames}});
        CHECK(answer["effects"].contains("joint-dynamics"));
        const int e = w.session.elementIndex(w.session.document().elementNamed("B")->id);
        const Points moving = w.session.character()->positions(e);
        CHECK(w.session.moving());
        w.good({{"do", "step"}, {"frames", static_cast<int>(10 * hertz)}, {"dt", 1.0 / hertz}});
        CHECK_FALSE(w.session.moving());
        const Points settled = w.session.character()->positions(e);
        w.good({{"do", "disable"}, {"effect", "joint-dynamics"}});
        const Points plain = w.session.character()->positions(w.session.elementIndex(w.session.document().elementNamed("B")->id));
        CHECK((settled - plain).cwiseAbs().maxCoeff() < 1e-6);
        CHECK((moving - settled).rowwise().norm().maxCoeff() > 1e-3);
        return Points(moving - settled);
    };
    const Points at60 = perform(60.0);
    const double amplitude = at60.rowwise().norm().maxCoeff();
    const double difference = (perform(240.0) - at60).rowwise().norm().maxCoeff();
    CAPTURE(difference / amplitude);
    // At 60 Hz a hand moves in steps of 1/60 s, before the flesh does: bones are up to half a step ahead.
    CHECK(difference < 0.03 * amplitude);
}

TEST_CASE("effects: a drag between frames stops nothing that swings or breathes") {
    Workbench w;
    w.buildChain();
    w.good(enable("joint-dynamics"));
    w.good(enable("inflate"));
    w.good(set("inflate", "breath", 0.1));
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    const Json drag = {{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.0, 0.0, 5.6}}};
    w.good(drag);
    w.good({{"do", "step"}, {"frames", 5}});
    const int b = w.session.elementIndex(w.session.document().elementNamed("B")->id);
    const Points swinging = w.session.character()->positions(b);
    w.good(drag);  // once more, to where it is held
    CHECK((w.session.character()->positions(b) - swinging).rowwise().norm().maxCoeff() < 1e-6);  // inverse kinematics settles a little more
    w.good({{"do", "step"}, {"frames", 1}});
    CHECK((w.session.character()->positions(b) - swinging).rowwise().norm().maxCoeff() > 1e-4);
    // A drag without seconds is a jump, which the flesh at the joints follows late.
    w.good(set("inflate", "breath", 0.0));
    w.good({{"do", "step"}, {"frames", 600}});
    const Points still = w.session.character()->positions(b);
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {-1.0, 0.0, 5.6}}});
    w.good({{"do", "step"}, {"frames", 3}});
    const Points late = w.session.character()->positions(b);
    w.good({{"do", "step"}, {"frames", 600}});
    CHECK((late - w.session.character()->positions(b)).rowwise().norm().maxCoeff() > 1e-3);
    CHECK((late - still).rowwise().norm().maxCoeff() > 0.1);
}

TEST_CASE("bend warp: twist that the basis \"paper\" cannot say is shown all the same") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "paper"}});
    w.good({{"do", "precompute"}});
    w.good(enable("bend-warp"));
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, 0.0, 6.0}}, {"roll", 0.01}});
    const int b = w.session.elementIndex(w.session.document().elementNamed("B")->id);
    const auto middle = [&] { return Points(w.session.character()->positions(b)); };
    const Points little = middle();
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.0, 0.0, 6.0}}, {"roll", 1.0}});
    const Points twisted = middle();
    int moved = 0;
    for (Eigen::Index v = 0; v < little.rows(); ++v)
        if (std::abs(little(v, 2) - 4.0) < 0.6 && (twisted.row(v) - little.row(v)).norm() > 0.02) ++moved;
    CHECK(moved > 0);
}

TEST_CASE("bend warp: a bent body keeps its volume, a body at rest its bytes") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const auto volumes = [&] { return w.good({{"do", "measure"}, {"what", "volume"}})["value"].get<double>(); };
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "pin"}, {"endpoint", "a/end"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3.0, 0.0, 3.0}}});
    const double plain = volumes();
    CHECK(w.good(enable("bend-warp"))["ms_per_frame"].get<double>() > 0.0);
    const double warped = volumes();
    CHECK(std::abs(warped - 6.0) < 0.25 * std::abs(plain - 6.0));
    CHECK(w.good({{"do", "step"}, {"frames", 2}})["effects"].contains("bend-warp"));
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"] == 0.0);
    w.good({{"do", "rest"}});
    CHECK(volumes() == doctest::Approx(6.0).epsilon(1e-6));
}

TEST_CASE("automatic bend warp: a pose that leaves what is linear is said with what mends it, which comes by itself, is saved, undone, and kept by takes to the bit") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    const Json check = {{"do", "check-pose"}};
    CHECK(w.good(check)["fits"] == true);
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "pin"}, {"endpoint", "a/end"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3.0, 0.0, 3.0}}});
    const Json said = w.good(check);
    CHECK(said["fits"] == false);
    REQUIRE(!said["leaves"].empty());
    CHECK(said["leaves"][0]["effect"] == "bend-warp");
    const Json mend = said["mend"]["command"];
    CHECK(mend == Json{{"do", "enable"}, {"effect", "bend-warp"}, {"auto", true}});
    CHECK(said["mend"]["ms_per_frame"].get<double>() > 0.0);
    CHECK(said["mend"]["precompute"] == false);

    const auto volumeOff = [&](Workbench& of) { return std::abs(of.good({{"do", "measure"}, {"what", "volume"}})["value"].get<double>() / 6.0 - 1.0); };
    CHECK(volumeOff(w) > 0.02);
    CHECK(w.good(mend)["auto"] == true);
    CHECK(volumeOff(w) < 0.02);
    CHECK(w.good(check)["fits"] == true);
    const Character& bent = *w.session.character();
    const int a = w.session.elementIndex(w.session.document().elementNamed("A")->id);
    CHECK(bent.warpPart(a) == 1.0);

    w.good({{"do", "undo"}});
    CHECK(!w.session.document().effects.has(EffectKind::BendWarp));
    w.good({{"do", "redo"}});
    CHECK(w.session.document().effects[EffectKind::BendWarp].automatic);
    CHECK(w.good({{"do", "enable"}, {"effect", "bend-warp"}, {"target", "A"}}).contains("auto"));
    CHECK(!w.good({{"do", "enable"}, {"effect", "bend-warp"}, {"auto", false}}).contains("auto"));
    w.good(mend);
    CHECK(w.code({{"do", "enable"}, {"effect", "gravity"}, {"auto", true}}) == "not-automatic");

    // From straight, through where it fades, to the bend: a take shows what was seen.
    w.good({{"do", "rest"}});
    CHECK(w.session.character()->warpPart(a) == 0.0);
    w.good({{"do", "record"}, {"take", "bend"}, {"action", "start"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "pin"}, {"endpoint", "a/end"}});
    std::vector<Points> seen;
    std::vector<double> parts;
    for (int i = 1; i <= 12; ++i) {
        const double angle = i * 0.13;
        w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {3.0 * std::sin(angle), 0.0, 3.0 + 3.0 * std::cos(angle)}}});
        w.good({{"do", "step"}, {"frames", 1}});
        seen.push_back(w.session.character()->positions(a));
        parts.push_back(w.session.character()->warpPart(a));
    }
    w.good({{"do", "record"}, {"take", "bend"}, {"action", "stop"}});
    CHECK(parts.front() == 0.0);
    CHECK(parts.back() == 1.0);
    CHECK(std::any_of(parts.begin(), parts.end(), [](double p) { return p > 0.0 && p < 1.0; }));
    const auto path = (Workbench::folder() / "automatic.imomushi").string();
    w.good({{"do", "save"}, {"path", path}});
    Workbench other;
    other.good({{"do", "open"}, {"path", path}});
    CHECK(other.session.document().effects == w.session.document().effects);
    const Take& take = *other.session.document().takes.begin()->second;
    REQUIRE(take.times.size() >= 13);
    other.good({{"do", "precompute"}});
    for (std::size_t i = 0; i < seen.size(); ++i) {
        other.good({{"do", "play"}, {"take", "bend"}, {"time", take.times[take.times.size() - seen.size() + i]}});
        CHECK(other.session.character()->positions(other.session.elementIndex(other.session.document().elementNamed("A")->id)) == seen[i]);
    }
}

TEST_CASE("previous model: joint faces move by themselves in the full basis, and their divergence is said and survived") {
    Workbench w;
    w.buildChain();
    w.good({{"do", "precompute"}});
    w.good(enable("previous-model"));
    CHECK(w.good({{"do", "step"}, {"frames", 1}})["warnings"].dump().find("basis") != std::string::npos);
    w.good({{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "full"}});
    w.good({{"do", "precompute"}});
    w.good({{"do", "pin"}, {"endpoint", "a/start"}});
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {2.0, 0.0, 5.0}}, {"seconds", 0.2}});
    const Json moving = w.good({{"do", "step"}, {"frames", 12}});
    CHECK(moving["effects"]["previous-model"]["median"].get<double>() > 0.0);
    CHECK(moving["finite"] == true);
    CHECK(w.session.moving());
    const int b = w.session.elementIndex(w.session.document().elementNamed("B")->id);
    CHECK(w.good({{"do", "step"}, {"frames", 1200}})["warnings"].empty());
    CHECK_FALSE(w.session.moving());
    CHECK(w.good({{"do", "measure"}, {"what", "gap"}})["value"] == 0.0);
    // It comes to rest where the faces are free of what the bones do not hold: not where they are rigid.
    const Points settled = w.session.character()->positions(b);
    w.good({{"do", "disable"}, {"effect", "previous-model"}});
    w.good({{"do", "step"}, {"frames", 1}});
    const Points rigid = w.session.character()->positions(w.session.elementIndex(w.session.document().elementNamed("B")->id));
    const double beyond = (settled - rigid).rowwise().norm().maxCoeff();
    CHECK(beyond > 1e-3);
    CHECK(beyond < 0.5);

    w.good(enable("previous-model"));
    w.good(set("previous-model", "step", 0.02));
    w.good(set("previous-model", "shear-modulus", 1e9));
    w.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {-2.0, 0.0, 5.0}}, {"seconds", 0.2}});
    const Json diverged = w.good({{"do", "step"}, {"frames", 120}});
    CHECK(diverged["finite"] == true);
    CHECK(diverged["warnings"].dump().find("diverged") != std::string::npos);
    w.good(set("previous-model", "step", 1e-3));
    w.good(set("previous-model", "shear-modulus", 3000.0));
    w.good({{"do", "rest"}});
    CHECK(w.good({{"do", "step"}, {"frames", 60}})["warnings"].empty());
}
