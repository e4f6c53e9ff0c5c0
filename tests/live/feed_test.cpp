// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <chrono>
#include <thread>

#include "core/live/input_feed.h"
#include "tests/document/workbench.h"
#include "tests/support/input_values.h"

using namespace imomushi;
using namespace std::chrono_literals;

namespace {

constexpr double kFeedHertz = 60.0;

/// Two bars whose bones swing; a control moves the end of the second one, and another one its roll.
struct Fed : Workbench {
    Fed() {
        buildChain();
        good({{"do", "pin"}, {"endpoint", "a/start"}});
        good({{"do", "precompute"}});
        good({{"do", "enable"}, {"effect", "bone-dynamics"}});
        good({{"do", "map-input"}, {"source", "pad"}, {"channel", "x"}, {"target", "bone/b/end/x"}, {"in", {-1, 1}}});
        good({{"do", "map-input"}, {"source", "pad"}, {"channel", "roll"}, {"target", "bone/b/end/roll"}, {"in", {-1, 1}}, {"hertz", 5}});
        REQUIRE(session.builtCharacter());
    }
    InputDriver driver() { return InputDriver(session.document(), session.plan(), {}); }
    template <class Until>
    bool wait(Until until) {
        const auto start = std::chrono::steady_clock::now();
        while (!until()) {
            if (std::chrono::steady_clock::now() - start > 60s) return false;
            session.takeFrame();
            std::this_thread::sleep_for(2ms);
        }
        return true;
    }
};

/// What the control says: packet i has one or two values.
std::vector<InputValue> packet(int i) {
    const double number = 0.5 * std::sin(0.05 * i);
    std::vector<InputValue> made{valueOf("pad", "x", {number})};
    if (i % 3 == 0) made.push_back(valueOf("pad", "roll", {number}));
    return made;
}

}  // namespace

TEST_CASE("feed: what another thread hears is performed step by step; the packets that steps took, and the script, make the same again") {
    Fed f;
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6}}});
    InputDriver again = f.driver();
    f.session.perform([] {});
    f.good({{"do", "record"}, {"take", "fed"}, {"action", "start"}});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    std::vector<std::uint64_t> steps;
    constexpr int kPackets = 300;
    std::thread hearing([&] {
        for (int i = 0; i < kPackets; ++i) {
            CHECK(feed->give(packet(i)));
            while (const auto taken = feed->takeStep()) steps.push_back(*taken);
            std::this_thread::sleep_for(3ms);
        }
    });
    hearing.join();
    CHECK(f.wait([&] {
        while (const auto taken = feed->takeStep()) steps.push_back(*taken);
        return !steps.empty() && steps.back() == kPackets;
    }));
    f.good({{"do", "record"}, {"take", "fed"}, {"action", "stop"}});
    f.session.performInputs(nullptr);
    CHECK(!f.session.holdInputs().value());
    // The script has the inputs of each step.
    const auto script = f.session.script();
    std::vector<Json> said;
    for (const Json& line : script)
        if (line.contains("inputs"))
            for (const Json& input : line["inputs"]) said.push_back({{"to", input["to"]}, {"roll", input.value("roll", 0.0)}});
    CHECK(said.size() > 30);
    // So does another driver that is given what steps took.
    std::vector<Json> made;
    int given = 0;
    for (const std::uint64_t taken : steps) {
        for (; given < static_cast<int>(taken); ++given)
            for (const InputValue& value : packet(given)) again.take(value);
        for (const LiveInput& input : again.step(1.0 / kFeedHertz)) made.push_back({{"to", {input.target.x(), input.target.y(), input.target.z()}}, {"roll", input.hasRoll ? input.roll : 0.0}});
    }
    REQUIRE(made.size() >= said.size());
    made.resize(said.size());  // steps went on until the recording stopped
    CHECK(made == said);
    Fed other;
    for (const Json& line : script)
        if (line["do"] == "drag" || line["do"] == "record" || line["do"] == "step") other.good(line);
    const Take &first = *f.session.document().takeNamed("fed"), &second = *other.session.document().takeNamed("fed");
    REQUIRE(first.times == second.times);
    std::vector<double> a(first.shapes.width()), b(second.shapes.width());
    REQUIRE(a.size() == b.size());
    for (std::size_t t = 0; t < first.times.size(); ++t) {
        first.shapes.at(t, a.data());
        second.shapes.at(t, b.data());
        CHECK(a == b);
    }
}

TEST_CASE("feed: what nobody holds is taken hold of by a command when it is moved, and goes on from there") {
    Fed f;
    const auto feed = std::make_shared<InputFeed>(f.driver());
    CHECK(!f.session.performInputs(feed));  // no thread steps
    f.session.perform([] {});
    REQUIRE(f.session.performInputs(feed));
    CHECK(f.session.moving());  // a step sees what is there
    InputValue value = packet(1).front();
    value.numbers[0] = 0.4;
    REQUIRE(feed->give(std::span(&value, 1)));
    const std::size_t before = f.session.steps().size();
    CHECK(f.wait([&] { return f.session.holdInputs().value(); }));
    CHECK(f.session.steps().size() == before + 1);
    const EndpointRef end = *f.session.document().endpoint("b/end");
    CHECK(f.wait([&] {
        (void)f.session.holdInputs();
        f.good({{"do", "list"}});  // the document becomes what is performed
        return (f.session.document().goals.at(end).target - Vec3(0.4, 0.0, 6.0)).norm() < 1e-9;
    }));
    CHECK(f.session.steps().size() == before + 1);
    f.session.performInputs(nullptr);
    CHECK(f.wait([&] { return !f.session.moving(); }));
}

TEST_CASE("feed: it is let go where the handles of the character are others; a packet that finds no room is lost whole") {
    Fed f;
    const auto feed = std::make_shared<InputFeed>(f.driver());
    f.session.perform([] {});
    REQUIRE(f.session.performInputs(feed));
    CHECK(feed.use_count() == 2);
    f.good({{"do", "handle"}, {"element", "B"}, {"name", "tip"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.4}});
    (void)f.session.moving();
    CHECK(feed.use_count() == 1);
    const std::vector<InputValue> many(1000, packet(1).front());
    for (std::size_t i = 0; i < InputFeed::kValues / many.size(); ++i) CHECK(feed->give(many));
    CHECK(!feed->give(many));
    CHECK(feed->give(std::span(many).first(InputFeed::kValues % many.size())));
    CHECK(!feed->give(std::span(many).first(1)));
}

TEST_CASE("feed: what inputs held is let go where nothing moves it any more, and what the artist holds since then is not") {
    Fed f;
    f.good({{"do", "disable"}, {"effect", "bone-dynamics"}});
    f.good({{"do", "handle"}, {"element", "A"}, {"name", "first"}, {"point", {0.5, 0.0, 1.5}}, {"radius", 0.2}});
    f.good({{"do", "handle"}, {"element", "B"}, {"name", "second"}, {"point", {-0.5, 0.0, 4.5}}, {"radius", 0.2}});
    f.good({{"do", "handle"}, {"element", "B"}, {"name", "third"}, {"point", {0.5, 0.0, 4.5}}, {"radius", 0.2}});
    f.good({{"do", "map-input"}, {"source", "pad"}, {"channel", "h"}, {"target", "handle/second/y"}, {"in", {-1, 1}}});
    f.good({{"do", "precompute"}});
    REQUIRE(f.session.builtCharacter());
    std::shared_ptr<InputFeed> feed;
    const auto hear = [&] {
        feed = std::make_shared<InputFeed>(f.driver());
        REQUIRE(f.session.performInputs(feed));
    };
    const auto isHeld = [&](const char* handle) {
        const auto goal = f.session.document().handleGoals.find({f.session.document().elementNamed("B")->id, handle});
        return goal != f.session.document().handleGoals.end() && goal->second.target.held;
    };
    f.session.perform([] {});
    hear();
    CHECK(feed->give(std::vector<InputValue>{valueOf("pad", "x", {0.5}), valueOf("pad", "h", {0.05})}));
    CHECK(f.wait([&] { return f.session.inputsWait() && f.session.holdInputs().value() && isHeld("second") && f.session.document().goals.size() == 2; }));
    // What drives them holds them.
    CHECK(f.wait([&] { return !f.session.moving(); }));
    CHECK(!f.session.inputsLeft());
    // Another handle gets its number, and the artist holds that.
    f.good({{"do", "remove-handle"}, {"handle", "first"}});
    f.good({{"do", "precompute"}});
    f.good({{"do", "drag"}, {"endpoint", "third"}, {"to", {0.55, 0.0, 4.5}}});
    hear();
    feed->letGo();
    CHECK(f.wait([&] { return f.session.inputsLeft(); }));
    CHECK(f.session.releaseInputs());
    CHECK(!isHeld("second"));
    CHECK(isHeld("third"));
    CHECK(f.session.document().goals.size() == 1);  // the pin
    // Where the hold was undone, what is held there later is the artist's.
    CHECK(feed->give(std::vector<InputValue>{valueOf("pad", "x", {0.8})}));
    CHECK(f.wait([&] { return f.session.inputsWait() && f.session.holdInputs().value(); }));
    f.good({{"do", "undo"}});
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.1, 0, 6}}});
    hear();
    feed->letGo();
    CHECK(f.wait([&] { return !f.session.moving(); }));
    std::this_thread::sleep_for(50ms);
    f.session.takeFrame();
    CHECK(!f.session.inputsLeft());
    CHECK(f.session.document().goals.size() == 2);
}

TEST_CASE("feed: ten seconds at rest with an open source make no step; the next packet is taken by the next step, though the window looks away") {
    Fed f;
    std::atomic<int> steps{0};
    f.session.perform([&] { ++steps; });
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6}}});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    const auto says = [&](double number) {
        const InputValue value = valueOf("pad", "x", {number});
        REQUIRE(feed->give(std::span(&value, 1)));
    };
    std::vector<std::uint64_t> packets;  // that were taken, by step
    const auto lookAtSteps = [&] {
        while (const auto taken = feed->takeStep()) packets.push_back(*taken);
    };
    says(0.4);
    REQUIRE(f.wait([&] {
        lookAtSteps();
        return !packets.empty() && packets.back() == 1 && !f.session.moving();
    }));
    const EndpointRef end = *f.session.document().endpoint("b/end");
    CHECK((f.session.document().goals.at(end).target - Vec3(0.4, 0.0, 6.0)).norm() < 1e-9);
    const int made = steps;
    for (int i = 0; i < 100; ++i) {
        std::this_thread::sleep_for(100ms);
        f.session.takeFrame();
        f.good({{"do", "list"}});  // whoever asks wakes nobody
    }
    CHECK(steps == made);
    CHECK(!f.session.moving());
    const Vec3 before = f.session.shownPose().points.back();
    says(0.5);
    // Nobody looks: the thread that gives has woken the one that steps.
    const auto start = std::chrono::steady_clock::now();
    while (steps < made + 10 && std::chrono::steady_clock::now() - start < 60s) std::this_thread::sleep_for(2ms);
    CHECK(steps >= made + 10);
    packets.clear();
    lookAtSteps();
    REQUIRE(!packets.empty());
    CHECK(packets.front() == 2);
    f.session.takeFrame();
    CHECK(f.session.moving());
    CHECK((f.session.shownPose().points.back() - before).norm() > 1e-3);
    REQUIRE(f.wait([&] { return !f.session.moving(); }));
    CHECK((f.session.document().goals.at(end).target - Vec3(0.5, 0.0, 6.0)).norm() < 1e-9);
    // So does the window.
    const int rested = steps;
    LiveInput hand;
    hand.end = end;
    hand.target = Vec3(0.2, 0.1, 6.0);
    REQUIRE(f.session.give(hand));
    CHECK(f.session.moving());
    REQUIRE(f.wait([&] { return !f.session.moving(); }));
    CHECK(steps > rested);
    CHECK((f.session.document().goals.at(end).target - hand.target).norm() < 1e-9);
    f.session.performInputs(nullptr);
}

TEST_CASE("feed: a source that has fallen silent glides to rest in time, though everything slept; the steps are made for that alone") {
    constexpr double kAfter = 3.0;
    Fed f;
    f.good({{"do", "map-input"}, {"source", "pad"}, {"channel", "y"}, {"target", "bone/b/end/y"}, {"in", {-1, 1}}, {"silence", "rest"}, {"after", kAfter}});
    std::atomic<int> steps{0};
    std::atomic<InputTime> last{0}, woke{0};  // when a step was made, and the first after a second without any
    f.session.perform([&] {
        const InputTime now = inputTime();
        if (last > 0 && now - last > 1'000'000'000 && woke == 0) woke = now;
        last = now;
        ++steps;
    });
    f.good({{"do", "disable"}, {"effect", "bone-dynamics"}});
    f.good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0, 0, 6}}});
    const auto feed = std::make_shared<InputFeed>(f.driver());
    REQUIRE(f.session.performInputs(feed));
    const EndpointRef end = *f.session.document().endpoint("b/end");
    const InputValue value = valueOf("pad", "y", {0.4});
    const InputTime said = inputTime();
    REQUIRE(feed->give(std::span(&value, 1)));
    // Nobody looks.
    const auto start = std::chrono::steady_clock::now();
    while (woke == 0 && std::chrono::steady_clock::now() - start < 60s) std::this_thread::sleep_for(5ms);
    REQUIRE(woke > 0);
    const double after = 1e-9 * static_cast<double>(woke - said);
    MESSAGE("after " << kAfter << " s of silence a step is made " << after << " s after what was heard last");
    CHECK(after >= kAfter - 1.0 / kFeedHertz);  // which the step that took it had as its own
    CHECK(after <= kAfter + 1.0);
    REQUIRE(f.wait([&] { return !f.session.moving() && feed->takeMeters() && feed->meters()[2].silent; }));
    CHECK((f.session.document().goals.at(end).target - Vec3(0.0, 0.0, 6.0)).norm() < 1e-9);
    const int made = steps;
    std::this_thread::sleep_for(500ms);
    CHECK(steps == made);
    f.session.performInputs(nullptr);
}
