// SPDX-License-Identifier: GPL-3.0-or-later
// Cycles through kept poses that controls drive.
#include "core/document/cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/live/direct_names.h"
#include "core/live/input_feed.h"
#include "core/live/live_character.h"
#include "tests/live/puppet.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kSettle = 20;  // steps: longer than a slot glides to another row

/// The chain bends through three poses, in which the man smiles 0.9, 0 and 0.3.
struct Dancer : Puppet {
    Dancer() {
        const double smiles[] = {0.9, 0.0, 0.3};
        for (int i = 0; i < 3; ++i) {
            good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {0.5 * i - 0.4, 0.3, 5.2 - 0.1 * i}}});
            good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", smiles[i]}});
            good({{"do", "keep-pose"}, {"name", std::string(1, static_cast<char>('p' + i))}});
            poses.push_back(session.document().pose);
        }
        good({{"do", "rest"}});
        good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.0}});
        good({{"do", "add-cycle"}, {"name", "dance"}, {"poses", {"p", "q", "r"}}, {"seconds", 2.0}});
        map("much", "cycle/dance/amount");
        map("fast", "cycle/dance/speed", {{"in", {-4.0, 4.0}}});
    }
    std::vector<Pose> poses;
};

double smileAt(double phase) { return 0.9 * cycleWeight(0, 3, phase) + 0.3 * cycleWeight(2, 3, phase); }

/// What it says last in so many steps.
struct Told {
    std::map<int, Vec3> places;  // of joint points
    double smile = 0.0;
    bool any = false;
};
Told after(InputDriver& driver, const CharacterPlan& plan, int steps) {
    Told told;
    for (int i = 0; i < steps; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            told.any = true;
            if (input.kind == LiveInput::Kind::End) told.places[plan.pointIndex(input.end)] = input.target;
            if (input.kind == LiveInput::Kind::Morph) told.smile = input.weight;
        }
    return told;
}

}  // namespace

TEST_CASE("cycle: with an amount alone it runs as it was made, and meets each of its poses") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    InputDriver driver = d.driver();
    CHECK(!after(driver, plan, 10).any);
    REQUIRE(driver.take(valueOf("face", "much", {1.0})));
    // The first step has phase already.
    for (int round = 0, step = 0; round < 2; ++round)
        for (std::size_t k = 0; k < 3; ++k) {
            const int until = 120 * round + 40 * static_cast<int>(k + 1);  // of 120 a round
            const Told told = after(driver, plan, until - step);
            step = until;
            const double phase = *driver.phaseOf("dance") - double(k + 1) / 3.0;
            CHECK(std::abs(phase - std::round(phase)) < 1e-9);
            const Pose& pose = d.poses[(k + 1) % 3];
            REQUIRE(told.places.size() == pose.points.size());
            for (const auto& [point, place] : told.places) CHECK((place - pose.points[static_cast<std::size_t>(point)]).norm() < 1e-8);
            CHECK(told.smile == doctest::Approx(smileAt(double(k + 1) / 3.0)).epsilon(1e-9));
        }
}

TEST_CASE("cycle: half of it goes half as far, at any phase, and its speed is times that of its making") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    InputDriver driver = d.driver();
    REQUIRE(driver.take(valueOf("face", "much", {0.5})));
    CHECK(after(driver, plan, 50).smile == doctest::Approx(0.5 * smileAt(50.0 / 120.0)).epsilon(1e-9));
    REQUIRE(driver.take(valueOf("face", "fast", {-2.0})));
    (void)after(driver, plan, kSettle);
    const double phase = *driver.phaseOf("dance");
    CHECK(after(driver, plan, 30).smile == doctest::Approx(0.5 * smileAt(phase - 0.5)).epsilon(1e-9));
    CHECK(*driver.phaseOf("dance") == doctest::Approx(phase - 0.5 + (phase < 0.5 ? 1.0 : 0.0)).epsilon(1e-9));
}

TEST_CASE("cycle: while it runs the driver does not rest, and where its amount or its speed is 0 it does") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    InputDriver driver = d.driver();
    (void)after(driver, plan, 1);
    CHECK(driver.rests() == kForever);
    REQUIRE(driver.take(valueOf("face", "fast", {3.0})));
    CHECK(!after(driver, plan, kSettle).any);  // there is nothing of it
    CHECK(driver.rests() == kForever);
    CHECK(*driver.phaseOf("dance") == 0.0);
    REQUIRE(driver.take(valueOf("face", "much", {0.7})));
    CHECK(driver.rests() == 0.0);
    (void)after(driver, plan, 500);
    CHECK(driver.rests() == 0.0);
    REQUIRE(driver.take(valueOf("face", "fast", {0.0})));
    (void)after(driver, plan, kSettle);
    CHECK(driver.rests() == kForever);  // it stands
    CHECK(!after(driver, plan, 5).any);
    REQUIRE(driver.take(valueOf("face", "fast", {1.0})));
    CHECK(after(driver, plan, 5).any);
    REQUIRE(driver.take(valueOf("face", "much", {0.0})));
    const Told told = after(driver, plan, kSettle);
    CHECK(driver.rests() == kForever);
    CHECK(told.smile == 0.0);
    for (const auto& [point, place] : told.places) CHECK((place - plan.input.skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
    // A filter comes near to 0, and near is nothing.
    d.map("much", "cycle/dance/amount", {{"hertz", 5.0}});
    InputDriver smooth = d.driver();
    for (const double much : {1.0, 0.0}) {
        REQUIRE(smooth.take(valueOf("face", "much", {much})));
        (void)after(smooth, plan, 90);
    }
    CHECK(smooth.rests() == kForever);
}

TEST_CASE("cycle: where everything lets go it glides to rest and stops") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    InputDriver driver = d.driver();
    REQUIRE(driver.take(valueOf("face", "much", {1.0})));
    (void)after(driver, plan, 50);
    driver.letGo();
    const Told half = after(driver, plan, 30);
    CHECK(std::abs(half.smile) < std::abs(smileAt(80.0 / 120.0)));
    const Told told = after(driver, plan, 40);
    CHECK(told.smile == 0.0);
    for (const auto& [point, place] : told.places) CHECK((place - plan.input.skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
    CHECK(driver.rests() == kForever);
}

TEST_CASE("cycle: a driver for a changed document goes on from where the one before was, and does not jump") {
    Dancer d;
    InputDriver driver = d.driver();
    REQUIRE(driver.take(valueOf("face", "much", {0.8})));
    REQUIRE(driver.take(valueOf("face", "fast", {1.5})));
    (void)after(driver, d.session.plan(), 77);
    const auto step = [&](bool holds) {
        for (const LiveInput& input : driver.step(kStep)) {
            if (input.kind == LiveInput::Kind::Morph) d.good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", input.weight}});
            if (input.kind == LiveInput::Kind::End) {
                const std::string end = d.session.document().bones.at(input.end.bone)->name + (input.end.atEnd ? "/end" : "/start");
                d.good({{"do", "drag"}, {"endpoint", end}, {"to", {input.target.x(), input.target.y(), input.target.z()}}, {"roll", input.roll}});
            }
            if (holds) driver.hold(input);
        }
    };
    step(true);
    step(false);
    d.map("other", "pose/p/weight");
    d.good({{"do", "rename-cycle"}, {"cycle", "dance"}, {"name", "waltz"}});
    InputDriver next(d.session.document(), d.session.plan(), kOsc, {}, &driver);
    CHECK(*next.phaseOf("waltz") == *driver.phaseOf("dance"));
    CHECK(next.rests() == 0.0);
    for (int i = 0; i < 50; ++i) {
        const Told was = after(driver, d.session.plan(), 1), is = after(next, d.session.plan(), 1);
        CHECK(is.smile == doctest::Approx(was.smile).epsilon(1e-12));
        for (const auto& [point, place] : is.places) CHECK((place - was.places.at(point)).norm() < 1e-9);
    }
    // Where there is nothing of it any more, nothing is left of it.
    REQUIRE(next.take(valueOf("face", "much", {0.0})));
    const Told rest = after(next, d.session.plan(), kSettle);
    CHECK(next.rests() == kForever);
    CHECK(std::abs(rest.smile) < 1e-12);
    for (const auto& [point, place] : rest.places) CHECK((place - d.session.plan().input.skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
    // One that nobody goes on from begins at the first pose, and so does one whose document is elsewhere by now.
    Document elsewhere = d.session.document();
    elsewhere.goals.clear();
    CHECK(*InputDriver(elsewhere, d.session.plan(), {}, {}, &driver).phaseOf("waltz") == 0.0);
    CHECK(*InputDriver(d.session.document(), d.session.plan(), {}).phaseOf("waltz") == 0.0);
    // What was letting go goes on to do so.
    REQUIRE(driver.take(valueOf("face", "much", {1.0})));
    (void)after(driver, d.session.plan(), kSettle);
    driver.letGo();
    (void)after(driver, d.session.plan(), 5);
    step(false);
    InputDriver resting(d.session.document(), d.session.plan(), kOsc, {}, &driver);
    CHECK(resting.rests() == 0.0);
    (void)after(resting, d.session.plan(), 70);
    CHECK(resting.rests() == kForever);
}

TEST_CASE("cycle: it is added to what drives poses, and several cycles to each other") {
    Dancer d;
    d.good({{"do", "add-cycle"}, {"name", "nod"}, {"poses", {"q", "r"}}, {"seconds", 1.0}});
    d.map("w", "pose/p/weight");
    d.map("nod", "cycle/nod/amount");
    InputDriver driver = d.driver();
    REQUIRE(driver.take(valueOf("face", "w", {0.25})));
    REQUIRE(driver.take(valueOf("face", "much", {0.5})));
    REQUIRE(driver.take(valueOf("face", "nod", {1.0})));
    const double smile = after(driver, d.session.plan(), 47).smile, phase = 47.0 / 120.0;
    CHECK(smile == doctest::Approx(0.25 * 0.9 + 0.5 * smileAt(phase) + 0.3 * cycleWeight(1, 2, 2.0 * phase)).epsilon(1e-9));
}

TEST_CASE("cycle: what rows say of the end of a limb is added to what it makes of that, the limb goes along, and a new driver goes on so") {
    Dancer d;
    d.map("up", "bone/b/end/y", {{"in", {-1.0, 1.0}}, {"out", {-0.5, 0.5}}});
    const CharacterPlan& plan = d.session.plan();
    const int tip = plan.pointIndex(*d.session.document().endpoint("b/end"));
    InputDriver alone = d.driver(), both = d.driver();
    std::map<int, Vec3> shown, added;
    const auto step = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            for (const auto& [point, place] : after(alone, plan, 1).places) shown[point] = place;
            for (const auto& [point, place] : after(both, plan, 1).places) added[point] = place;
        }
    };
    for (InputDriver* driver : {&alone, &both}) REQUIRE(driver->take(valueOf("face", "much", {1.0})));
    step(30);
    REQUIRE(both.take(valueOf("face", "up", {1.0})));
    double before = 0.0;
    for (int i = 0; i < 100; ++i) {
        step(1);
        const double up = (added[tip] - shown[tip]).y();
        // It comes by a glide, and stays while the cycle goes on.
        CHECK(up >= before - 1e-9);
        before = up;
        CHECK((added[tip] - shown[tip] - Vec3(0.0, up, 0.0)).norm() < 1e-9);
        // Bones keep the lengths that the cycle gives them.
        for (const auto& b : plan.input.skeleton.bones) {
            const double is = (added[b.end] - added[b.start]).norm(), was = (shown[b.end] - shown[b.start]).norm();
            CHECK(is == doctest::Approx(was).epsilon(0.03));  // the chain is too short where the cycle stretches it
        }
    }
    CHECK(before == doctest::Approx(0.5).epsilon(1e-9));
    // Where there is nothing of the cycle any more, the limb still goes along, and is at rest where its end is.
    for (InputDriver* driver : {&alone, &both}) REQUIRE(driver->take(valueOf("face", "much", {0.0})));
    step(2 * kSettle);
    const Skeleton& skeleton = plan.input.skeleton;
    CHECK((added[tip] - skeleton.points[static_cast<std::size_t>(tip)] - Vec3(0.0, 0.5, 0.0)).norm() < 1e-9);
    int middle = 0;
    for (const auto& b : skeleton.bones)
        if (b.end != tip) {
            CHECK(added[b.end].y() > skeleton.points[static_cast<std::size_t>(b.end)].y() + 0.01);
            ++middle;
        }
    CHECK(middle > 0);
    // Let go, it glides there.
    both.letGo();
    double was = 0.5;
    for (int i = 0; i < 70; ++i) {
        step(1);
        const double is = added[tip].y() - skeleton.points[static_cast<std::size_t>(tip)].y();
        CHECK(is <= was + 1e-9);
        CHECK(is > was - 0.02);
        was = is;
    }
    for (const auto& [point, place] : added) CHECK((place - skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
}

TEST_CASE("cycle: everybody who sends OSC drives it by its name, one source may be given cycles alone, and rows of the table win over both") {
    Dancer d;
    bool named = false;
    for (const DirectName& name : directNames(d.session.document())) named = named || (name.address == "/imomushi/cycle/dance/speed" && name.count == 1);
    CHECK(named);
    const std::vector<std::string> window = {"window"};
    InputDriver driver(d.session.document(), d.session.plan(), kOsc, window);
    CHECK(!driver.take(valueOf("window", "/imomushi/pose/p", {1.0})));
    REQUIRE(driver.take(valueOf("window", "/imomushi/cycle/dance/amount", {0.6})));
    // It is smoothed: its fader goes by steps.
    CHECK(after(driver, d.session.plan(), 40).smile == doctest::Approx(0.6 * smileAt(1.0 / 3.0)).epsilon(1e-6));
    REQUIRE(driver.take(valueOf("osc", "/imomushi/cycle/dance/amount", {2.0})));
    CHECK(after(driver, d.session.plan(), 30).smile == doctest::Approx(2.0 * smileAt(70.0 / 120.0)).epsilon(1e-9));
    REQUIRE(driver.take(valueOf("face", "much", {1.0})));
    CHECK(after(driver, d.session.plan(), 30).smile == doctest::Approx(smileAt(100.0 / 120.0)).epsilon(1e-9));
}

TEST_CASE("cycle: one whose poses are not all there drives nothing") {
    Dancer d;
    Document document = d.session.document();
    setCycles(document, {Cycle{"dance", {"p", "lost"}, 1.0}});
    InputDriver driver(document, d.session.plan(), kOsc);
    CHECK(!driver.take(valueOf("face", "much", {1.0})));
    CHECK(!driver.phaseOf("dance"));
}

TEST_CASE("cycle: steps allocate nothing, and the same values and steps are the same bytes") {
    Dancer d;
    InputDriver driver = d.driver(), again = d.driver();
    const auto much = valueOf("face", "much", {1.0});
    const std::size_t before = allocations();
    (void)driver.take(much);
    for (int i = 0; i < 200; ++i) (void)driver.step(kStep);
    CHECK(allocations() == before);
    (void)again.take(much);
    for (int i = 0; i < 200; ++i) (void)again.step(kStep);
    const auto one = driver.step(kStep), other = again.step(kStep);
    REQUIRE(one.size() == other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        CHECK(one[i].target == other[i].target);
        CHECK(one[i].weight == other[i].weight);
    }
}

TEST_CASE("cycle: the limb goes along with a hand that holds its end, and goes on from where the hand leaves it") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    const int tip = plan.pointIndex(*d.session.document().endpoint("b/end"));
    InputDriver alone = d.driver(), held = d.driver();
    std::map<int, Vec3> shown, places;
    const auto step = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            for (const auto& [point, place] : after(alone, plan, 1).places) shown[point] = place;
            for (const auto& [point, place] : after(held, plan, 1).places) places[point] = place;
        }
    };
    for (InputDriver* driver : {&alone, &held}) REQUIRE(driver->take(valueOf("face", "much", {1.0})));
    step(30);
    LiveInput hand;
    hand.end = std::ranges::find_if(plan.points, [&](const auto& p) { return p.second == tip; })->first;
    const Vec3 from = places[tip];
    for (int i = 1; i <= 60; ++i) {
        hand.target = from + i / 60.0 * Vec3(0.0, 0.5, -0.2);
        held.giveToHand(hand);
        places.erase(tip);
        step(1);
        CHECK(!places.contains(tip));
        places[tip] = hand.target;
        // Bones keep the lengths that the cycle gives them: none is torn out of the chain.
        for (const auto& b : plan.input.skeleton.bones) {
            const double is = (places[b.end] - places[b.start]).norm(), was = (shown[b.end] - shown[b.start]).norm();
            CHECK(is == doctest::Approx(was).epsilon(0.05));
        }
    }
    // It goes on from there without a jump, and after a whole round of the cycle it is there again.
    held.hold(hand);
    auto before = places;
    const auto left = places;
    constexpr int kRound = 120;
    for (int i = 0; i < kRound; ++i) {
        step(1);
        for (const auto& [point, place] : places) CHECK((place - before[point]).norm() < 0.06);
        before = places;
    }
    for (const auto& [point, place] : places) CHECK((place - left.at(point)).norm() < 0.02);
}

TEST_CASE("cycle: where a drag is given up and its end is back where it was, no bone of the limb is torn") {
    Dancer d;
    const CharacterPlan& plan = d.session.plan();
    const int tip = plan.pointIndex(*d.session.document().endpoint("b/end"));
    InputDriver alone = d.driver(), held = d.driver();
    for (InputDriver* driver : {&alone, &held}) REQUIRE(driver->take(valueOf("face", "much", {1.0})));
    auto shown = after(alone, plan, 30).places, places = after(held, plan, 30).places;
    LiveInput hand;
    hand.end = std::ranges::find_if(plan.points, [&](const auto& p) { return p.second == tip; })->first;
    const Vec3 from = places[tip];
    for (int i = 1; i <= 20; ++i) {
        hand.target = from + i / 20.0 * Vec3(0.4, 0.5, -0.3);
        held.giveToHand(hand);
        (void)held.step(kStep);
    }
    hand.target = from;
    held.hold(hand);
    for (const auto& [point, place] : after(held, plan, 1).places) places[point] = place;
    for (const auto& [point, place] : after(alone, plan, 21).places) shown[point] = place;
    CHECK((places[tip] - from).norm() < 0.06);
    for (const auto& b : plan.input.skeleton.bones) CHECK((places[b.end] - places[b.start]).norm() == doctest::Approx((shown[b.end] - shown[b.start]).norm()).epsilon(0.05));
}

TEST_CASE("cycle: a control that says there is nothing of it holds no bone") {
    Dancer d;
    InputDriver driver = d.driver();
    REQUIRE(driver.take(valueOf("face", "much", {0.0})));
    CHECK(!after(driver, d.session.plan(), kSettle).any);
}
