// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of effects and weights of morph targets that live input drives.
#include <chrono>
#include <thread>

#include "core/live/input_feed.h"
#include "core/live/performance.h"
#include "core/mesh/render_model.h"
#include "tests/document/workbench.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

/// Two bars that swing above the ground, and a man who can smile; knobs drive how they swing, gravity, and the smile.
struct Knobs : Workbench {
    Knobs() {
        buildChain();
        good({{"do", "pin"}, {"endpoint", "a/start"}});
        good({{"do", "precompute"}});
        good({{"do", "enable"}, {"effect", "bone-dynamics"}});
        good({{"do", "enable"}, {"effect", "gravity"}});
        session.services().importCharacter = [](const ImportRequest& request, const Progress& progress) {
            auto file = characterFile(request, progress);
            MorphTarget smile;
            smile.name = "smile";
            smile.vertices = {0};
            smile.deltas.setConstant(1, 3, 0.01);
            file->renderModel.morphs.push_back(smile);
            return file;
        };
        good({{"do", "import-character"}, {"path", "ball"}, {"name", "man"}});
        map("swing", "effect/bone-dynamics/swing-hertz", {0.0, 20.0});
        map("fall", "effect/gravity/acceleration/y", {0.0, -30.0});
        map("joy", "morph/man/smile", {0.0, 1.0});
        REQUIRE(session.builtCharacter());
    }
    void map(const std::string& channel, const std::string& target, const Json& out) { good({{"do", "map-input"}, {"source", "midi"}, {"channel", channel}, {"target", target}, {"out", out}}); }
    InputDriver driver() { return InputDriver(session.document(), session.plan(), {}); }
    [[nodiscard]] double swing() const { return session.document().effects.number(EffectKind::BoneDynamics, "swing-hertz"); }
    [[nodiscard]] double fall() const { return session.document().effects.vector(EffectKind::Gravity, "acceleration").y(); }
    [[nodiscard]] double smile() const { return session.document().morphs.empty() ? 0.0 : session.document().morphs.begin()->second; }
    template <class Until>
    bool wait(Until until) {
        const auto start = std::chrono::steady_clock::now();
        while (!until()) {
            if (std::chrono::steady_clock::now() - start > 60s) return false;
            session.takeFrame();
            (void)session.holdInputs();
            good({{"do", "list"}});  // the document becomes what is performed
            std::this_thread::sleep_for(2ms);
        }
        return true;
    }
};

bool says(InputFeed& feed, const char* channel, double number) {
    const InputValue value = valueOf("midi", channel, {number});
    return feed.give(std::span(&value, 1));
}

}  // namespace

TEST_CASE("numbers: a knob drives a setting of an effect and a weight, each as one step, and undo leads back to what they were") {
    Knobs f;
    const double swing = f.swing(), fall = f.fall();
    f.session.perform([] {});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    const auto steps = f.session.position();
    REQUIRE(says(*feed, "swing", 0.75));
    CHECK(f.wait([&] { return f.swing() == doctest::Approx(15.0); }));
    CHECK(f.session.position() == steps + 1);
    REQUIRE(says(*feed, "swing", 0.5));
    CHECK(f.wait([&] { return f.swing() == doctest::Approx(10.0); }));
    CHECK(f.session.position() == steps + 1);  // the same gesture
    REQUIRE(says(*feed, "joy", 0.6));
    CHECK(f.wait([&] { return f.smile() == doctest::Approx(0.6); }));
    CHECK(f.session.position() == steps + 2);
    REQUIRE(says(*feed, "fall", 1.0));
    CHECK(f.wait([&] { return f.fall() == doctest::Approx(-30.0); }));
    CHECK(f.session.position() == steps + 3);
    CHECK(f.session.modified());
    // What is shown is stepped by these numbers.
    CHECK(f.session.character() != nullptr);

    f.good({{"do", "undo"}});
    CHECK(f.fall() == fall);
    CHECK(f.swing() == doctest::Approx(10.0));
    CHECK(f.smile() == doctest::Approx(0.6));
    f.good({{"do", "undo"}, {"count", 2}});
    CHECK(f.swing() == swing);
    CHECK(f.session.document().morphs.empty());
    f.good({{"do", "redo"}});
    CHECK(f.swing() == doctest::Approx(10.0));
    // What was undone is held anew, as a step of its own.
    REQUIRE(says(*feed, "joy", 0.3));
    CHECK(f.wait([&] { return f.smile() == doctest::Approx(0.3); }));
    CHECK(f.session.position() == steps + 2);
    f.session.performInputs(nullptr);
}

TEST_CASE("numbers: in a gesture all that was taken hold of is one step") {
    Knobs f;
    const double swing = f.swing(), fall = f.fall();
    f.session.perform([] {});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    const auto steps = f.session.position();
    for (const char* channel : {"swing", "fall", "joy"}) REQUIRE(says(*feed, channel, 1.0));
    const auto start = std::chrono::steady_clock::now();
    while (!f.session.inputsWait() && std::chrono::steady_clock::now() - start < 60s) std::this_thread::sleep_for(2ms);
    f.session.beginGesture();
    CHECK(f.session.holdInputs().value());
    f.session.endGesture();
    CHECK(f.wait([&] { return f.swing() == doctest::Approx(20.0) && f.smile() == doctest::Approx(1.0) && f.fall() == doctest::Approx(-30.0); }));
    CHECK(f.session.position() == steps + 1);
    f.good({{"do", "undo"}});
    CHECK(f.swing() == swing);
    CHECK(f.fall() == fall);
    CHECK(f.session.document().morphs.empty());
    f.session.performInputs(nullptr);
}

TEST_CASE("numbers: the script has what a knob said, and makes the same take again") {
    Knobs f;
    f.session.perform([] {});
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.5, 0, 6}}});
    f.good({{"do", "record"}, {"take", "knobs"}, {"action", "start"}});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    REQUIRE(says(*feed, "swing", 0.4));
    REQUIRE(says(*feed, "fall", 0.3));
    CHECK(f.wait([&] { return f.swing() == doctest::Approx(8.0) && f.fall() == doctest::Approx(-9.0); }));
    f.good({{"do", "record"}, {"take", "knobs"}, {"action", "stop"}});
    f.session.performInputs(nullptr);
    Knobs again;
    bool driven = false;
    for (const Json& line : f.session.script()) {
        if (line.contains("inputs"))
            for (const Json& input : line["inputs"]) driven = driven || input.contains("effect");
        if (line["do"] == "drag" || line["do"] == "record" || line["do"] == "step" || line["do"] == "set") again.good(line);
    }
    CHECK(driven);
    CHECK(again.swing() == f.swing());
    const Take &first = *f.session.document().takeNamed("knobs"), &second = *again.session.document().takeNamed("knobs");
    REQUIRE(first.times == second.times);
    std::vector<double> a(first.shapes.width()), b(second.shapes.width());
    for (std::size_t t = 0; t < first.times.size(); ++t) {
        first.shapes.at(t, a.data());
        second.shapes.at(t, b.data());
        CHECK(a == b);
    }
}

TEST_CASE("numbers: an input of a step sets a setting of an effect within its bounds, and what is none is refused") {
    Knobs f;
    f.good({{"do", "step"}, {"frames", 2}, {"inputs", {{{"frame", 0}, {"effect", "bone-dynamics"}, {"property", "swing-hertz"}, {"value", 3.0}}, {{"frame", 1}, {"effect", "gravity"}, {"property", "acceleration"}, {"axis", 1}, {"value", -2.0}}}}});
    CHECK(f.swing() == 3.0);
    CHECK(f.fall() == -2.0);
    const auto code = [&](const Json& input) { return f.code({{"do", "step"}, {"frames", 1}, {"inputs", {input}}}); };
    CHECK(code({{"frame", 0}, {"effect", "bone-dynamics"}, {"property", "swing-hertz"}, {"value", -1.0}}) != "ok");
    CHECK(code({{"frame", 0}, {"effect", "bone-dynamics"}, {"property", "colour"}, {"value", 1.0}}) == "no-such-property");
    CHECK(code({{"frame", 0}, {"effect", "magic"}, {"property", "x"}, {"value", 1.0}}) == "no-such-effect");
    CHECK(code({{"frame", 0}, {"effect", "gravity"}, {"property", "acceleration"}, {"value", 1.0}}) == "bad-value");
    CHECK(code({{"frame", 0}, {"effect", "gravity"}, {"property", "acceleration"}, {"axis", 1}}) == "bad-type");
    CHECK(code({{"frame", 0}, {"effect", "gravity"}, {"property", "acceleration"}, {"axis", 1}, {"value", 1.0}, {"to", {0, 0, 0}}}) == "unknown-key");
}

TEST_CASE("numbers: bones and flesh act by a driven setting at once, and giving it takes no memory") {
    Knobs f;
    Document document = f.session.document();
    Performance bones = *Performance::build(document, f.session.plan());
    auto settings = document.effects.settings(EffectKind::Gravity);
    const std::size_t before = allocations();
    document.effects[EffectKind::BoneDynamics].values[0] = 5.0;
    REQUIRE(bones.set(document.effects).has_value());
    document.effects[EffectKind::BoneDynamics].values[0] = 6.0;
    REQUIRE(bones.set(document.effects).has_value());
    readNumbers(document.effects, EffectKind::Gravity, *settings);
    CHECK(allocations() == before);
}

TEST_CASE("numbers: what a knob becomes stays within the bounds of the setting") {
    Knobs f;
    f.map("swing", "effect/bone-dynamics/swing-hertz", {-50.0, 5000.0});
    InputDriver driver = f.driver();
    const auto last = [&](double knob) {
        driver.take(valueOf("midi", "swing", {knob}));
        double now = 0.0;
        for (int i = 0; i < 60; ++i)
            for (const LiveInput& input : driver.step(1.0 / 60.0))
                if (input.kind == LiveInput::Kind::Effect) now = input.weight;
        return now;
    };
    CHECK(last(1.0) == 1000.0);
    CHECK(last(0.0) == 0.01);
    // For panic it goes back to what it was.
    driver.letGo();
    double now = 0.0;
    for (int i = 0; i < 120; ++i)
        for (const LiveInput& input : driver.step(1.0 / 60.0)) now = input.weight;
    CHECK(now == doctest::Approx(f.swing()));
}
