// SPDX-License-Identifier: GPL-3.0-or-later
// Weights of kept poses that controls drive.
#include <map>

#include "core/live/direct_names.h"
#include "tests/live/puppet.h"
#include "tests/support/allocations.h"
#include "tests/support/input_values.h"

using namespace imomushi;

namespace {

/// The chain stands at rest; "bow" bends and lifts it, "smile" is a face alone.
struct Actor : Puppet {
    Actor() {
        good({{"do", "drag"}, {"endpoint", "b/end"}, {"to", {1.6, 0.4, 4.9}}, {"roll", 0.4}});
        good({{"do", "drag"}, {"endpoint", "a/start"}, {"to", {0.2, 0.3, 0.1}}});
        good({{"do", "step"}, {"frames", 60}});
        good({{"do", "keep-pose"}, {"name", "bow"}});
        bow = poseNow();
        good({{"do", "rest"}});
        good({{"do", "morph"}, {"character", "man"}, {"target", "smile"}, {"weight", 0.8}});
        good({{"do", "keep-pose"}, {"name", "smile"}});
        good({{"do", "rest"}});
        map("w", "pose/bow/weight");
        map("joy", "pose/smile/weight");
    }
    [[nodiscard]] Pose poseNow() const { return session.document().pose; }
    Pose bow;
};

/// Where joint points are told to be after so many steps; the others are not in it.
std::map<int, Vec3> placesAfter(InputDriver& driver, const CharacterPlan& plan, int steps = 60) {
    std::map<int, Vec3> places;
    for (int i = 0; i < steps; ++i)
        for (const LiveInput& input : driver.step(kStep))
            if (input.kind == LiveInput::Kind::End) places[plan.pointIndex(input.end)] = input.target;
    return places;
}

}  // namespace

TEST_CASE("pose weight: at 1 all joint points are where the pose has them, at 0 where they rest") {
    Actor a;
    const CharacterPlan& plan = a.session.plan();
    InputDriver driver = a.driver();
    CHECK(driver.step(kStep).empty());
    REQUIRE(driver.take(valueOf("face", "w", {1.0})));
    const auto at = placesAfter(driver, plan);
    REQUIRE(at.size() == a.bow.points.size());
    for (const auto& [point, place] : at) CHECK((place - a.bow.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
    REQUIRE(driver.take(valueOf("face", "w", {0.0})));
    for (const auto& [point, place] : placesAfter(driver, plan)) CHECK((place - plan.input.skeleton.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
}

TEST_CASE("pose weight: what is taken hold of a few steps later, where it still is, arrives where the pose has it") {
    Actor a;
    a.good({{"do", "drag"}, {"endpoint", "tip"}, {"to", {0.9, 0.2, 4.7}}});
    a.good({{"do", "keep-pose"}, {"name", "reach"}});
    a.good({{"do", "rest"}});
    a.map("r", "pose/reach/weight");
    const CharacterPlan& plan = a.session.plan();
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("face", "w", {1.0})));
    REQUIRE(driver.take(valueOf("face", "r", {1.0})));
    for (int i = 0; i < 4; ++i)
        for (LiveInput input : driver.step(kStep)) {
            if (input.kind == LiveInput::Kind::End) input.target = plan.input.skeleton.points[static_cast<std::size_t>(plan.pointIndex(input.end))];
            if (input.kind == LiveInput::Kind::Handle) input.target = a.session.document().elementNamed("B")->faces.back().frame.origin;
            if (i == 3) driver.hold(input);
        }
    const int start = plan.pointIndex({a.session.document().boneNamed("a")->id, false});
    std::map<int, Vec3> at;
    Vec3 tip = Vec3::Zero();
    for (int i = 0; i < 60; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            if (input.kind == LiveInput::Kind::End) at[plan.pointIndex(input.end)] = input.target;
            if (input.kind == LiveInput::Kind::Handle) tip = input.target;
        }
    REQUIRE(at.contains(start));
    CHECK((tip - Vec3(0.9, 0.2, 4.7)).norm() < 1e-9);
    CHECK((a.bow.points[static_cast<std::size_t>(start)] - plan.input.skeleton.points[static_cast<std::size_t>(start)]).norm() > 0.3);
    CHECK((at.at(start) - a.bow.points[static_cast<std::size_t>(start)]).norm() < 1e-9);
}

TEST_CASE("pose weight: half way bones are as long as the mean, and rolls are half of them") {
    Actor a;
    const CharacterPlan& plan = a.session.plan();
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("face", "w", {0.5})));
    double roll = 0.0;
    std::map<int, Vec3> at;
    for (int i = 0; i < 60; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            if (input.kind != LiveInput::Kind::End) continue;
            at[plan.pointIndex(input.end)] = input.target;
            if (input.end.atEnd) roll = std::max(roll, input.roll);
        }
    for (const auto& bone : plan.input.skeleton.bones) {
        const double posed = (a.bow.points[static_cast<std::size_t>(bone.end)] - a.bow.points[static_cast<std::size_t>(bone.start)]).norm();
        CHECK((at.at(bone.end) - at.at(bone.start)).norm() == doctest::Approx(0.5 * (bone.length + posed)).epsilon(1e-9));
    }
    // A twist and a bend in one rotation vector: the roll is half of it but for the second order.
    CHECK(roll == doctest::Approx(0.2).epsilon(0.1));
}

TEST_CASE("pose weight: poses add, and each number of a face goes with its own") {
    Actor a;
    const CharacterPlan& plan = a.session.plan();
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("face", "w", {1.0})));
    REQUIRE(driver.take(valueOf("osc", "/imomushi/pose/smile", {0.5})));
    std::map<int, Vec3> at;
    double smile = 0.0;
    for (int i = 0; i < 60; ++i)
        for (const LiveInput& input : driver.step(kStep)) {
            if (input.kind == LiveInput::Kind::End) at[plan.pointIndex(input.end)] = input.target;
            if (input.kind == LiveInput::Kind::Morph) smile = input.weight;
        }
    CHECK(smile == doctest::Approx(0.4).epsilon(1e-6));
    for (const auto& [point, place] : at) CHECK((place - a.bow.points[static_cast<std::size_t>(point)]).norm() < 1e-9);
}

TEST_CASE("pose weight: one that begins in the middle of a pose knows how much of it there is, and nothing jumps") {
    Actor a;
    a.good({{"do", "apply-pose"}, {"name", "bow"}});
    const CharacterPlan& plan = a.session.plan();
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("face", "w", {1.0})));
    // Inverse kinematics had the last word on the pose that is shown.
    for (const auto& [point, place] : placesAfter(driver, plan)) CHECK((place - a.bow.points[static_cast<std::size_t>(point)]).norm() < 1e-7);
    REQUIRE(driver.take(valueOf("face", "w", {0.99})));
    const auto at = placesAfter(driver, plan);
    REQUIRE(at.size() == a.bow.points.size());
    for (const auto& [point, place] : at) {
        const Vec3 bowed = a.bow.points[static_cast<std::size_t>(point)], rest = plan.input.skeleton.points[static_cast<std::size_t>(point)];
        CHECK((place - bowed).norm() < 0.02 * (rest - bowed).norm());
        CHECK((place - bowed).norm() > 0.005 * (rest - bowed).norm());
    }
}

TEST_CASE("pose weight: what a hand left there stays as it is under the pose, and a pinned end stays at its pin") {
    Actor a;
    const CharacterPlan& plan = a.session.plan();
    const int tip = plan.pointIndex({a.session.document().boneNamed("b")->id, true});
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("face", "w", {1.0})));
    (void)placesAfter(driver, plan);
    LiveInput held;
    held.kind = LiveInput::Kind::End;
    held.end = {a.session.document().boneNamed("b")->id, true};
    held.target = a.bow.points[static_cast<std::size_t>(tip)] + Vec3(0.3, 0.0, 0.0);
    driver.giveToHand(held);
    driver.hold(held);
    REQUIRE(driver.take(valueOf("face", "w", {0.999})));
    for (const auto& [point, place] : placesAfter(driver, plan))
        if (point == tip) CHECK((place - held.target).norm() < 0.01);

    a.good({{"do", "pin"}, {"endpoint", "b/end"}});
    InputDriver pinned = a.driver();
    REQUIRE(pinned.take(valueOf("face", "w", {1.0})));
    const auto at = placesAfter(pinned, a.session.plan());
    CHECK(!at.contains(tip));
    CHECK(at.size() == a.bow.points.size() - 1);
}

TEST_CASE("pose weight: rows follow the name of a pose, and what is not kept any more drives nothing") {
    Actor a;
    a.good({{"do", "rename-pose"}, {"pose", "bow"}, {"name", "deep bow"}});
    CHECK((*a.session.document().mappings)[0].target == "pose/deep bow/weight");
    CHECK(mappedTarget(a.session.document(), "pose/deep bow/weight")->kind == MappedTarget::Kind::Pose);
    a.good({{"do", "remove-pose"}, {"pose", "deep bow"}});
    CHECK(mappedTarget(a.session.document(), "pose/deep bow/weight").error().code == "no-such-pose");
    InputDriver driver = a.driver();
    CHECK(!driver.take(valueOf("face", "w", {1.0})));
    CHECK(!mappedTarget(a.session.document(), "pose/smile/height"));
}

TEST_CASE("pose weight: steps allocate nothing") {
    Actor a;
    InputDriver driver = a.driver();
    const auto values = [](double w) { return std::pair(valueOf("face", "w", {w}), valueOf("face", "joy", {1.0 - w})); };
    const auto first = values(0.3), second = values(0.9);
    const std::size_t before = allocations();
    for (int i = 0; i < 50; ++i) {
        const auto& [w, joy] = i % 2 ? first : second;
        (void)driver.take(w);
        (void)driver.take(joy);
        (void)driver.step(kStep);
    }
    CHECK(allocations() == before);
}

TEST_CASE("pose weight: a pose that nobody drives holds no roll of what is moved by its place") {
    Actor a;
    InputDriver driver = a.driver();
    REQUIRE(driver.take(valueOf("osc", "/imomushi/bone/b/end/position", {0.3, 0.0, 5.5})));
    const auto end = lastOf(driver, LiveInput::Kind::End);
    REQUIRE(end);
    CHECK((end->target - Vec3(0.3, 0.0, 5.5)).norm() < 1e-9);
    CHECK(!end->hasRoll);
}
