// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/skeleton/bone_tree.h"
#include "core/skeleton/inverse_kinematics.h"
#include "tests/dynamics/bones.h"
#include "tests/support/allocations.h"

using namespace imomushi;

TEST_CASE("bone dynamics: bodies of a micrometre and of a thousand kilometres move alike") {
    std::vector<Pose> seen;
    for (const double size : {1.0, 1e-6, 1e6}) {
        const Skeleton s = boneChain(4, size);
        auto input = inputOf(s);
        for (double& m : input.mass) m *= size * size * size;
        input.settings.gravity = Vec3(0, -5.0 * size, 0);
        input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.2 * size), 0.3};
        auto dynamics = BoneDynamics::build(input).value();
        const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
        Pose pose = restPose(s);
        for (int i = 0; i < 100; ++i) {
            if (i < 20)
                for (auto& p : pose.points) p += size * Vec3(0.0, 0.03, 0.02);
            dynamics.step(kFrame, pose, goals);
        }
        seen.push_back(dynamics.pose());
        for (auto& p : seen.back().points) p /= size;
    }
    CHECK(farthestFrom(seen[0], seen[1]) < 1e-6);
    CHECK(farthestFrom(seen[0], seen[2]) < 1e-6);
}

TEST_CASE("bone dynamics: no bones, or single points, are a character, too") {
    Skeleton s;
    auto none = make(s);
    none.step(kFrame, restPose(s), {});
    CHECK(none.pose().points.empty());
    s.points = {Vec3(1, 2, 3)};
    auto input = inputOf(s);
    input.settings.gravity = Vec3(0, -1, 0);
    input.settings.returnHertz = 0.0;
    auto point = BoneDynamics::build(input).value();
    for (int i = 0; i < 60; ++i) point.step(kFrame, restPose(s), {});
    CHECK(point.pose().points[0].y() == doctest::Approx(1.5));
}

TEST_CASE("bone dynamics: a pause of ten seconds is cut short and said") {
    const Skeleton s = boneChain(5);
    auto dynamics = make(s);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, curled(s, 0.0), goals);
    dynamics.step(10.0, curled(s, 0.5), goals);
    CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::TimeDropped));
    checkFinite(dynamics.pose());
    CHECK(farthestFrom(dynamics.pose(), curled(s, 0.5)) < 5.0);
    dynamics.step(1e300, curled(s, 0.5), goals);
    checkFinite(dynamics.pose());
    dynamics.step(0.0, curled(s, 0.5), goals);
    CHECK(dynamics.warnings() == 0u);
}

TEST_CASE("bone dynamics: what is not finite does not go on: the last good state stays, and it is said") {
    const Skeleton s = boneChain(4);
    auto dynamics = make(s);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, curled(s, 0.2), goals);
    const Pose good = dynamics.pose();
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinite, 1e300}) {
        Pose pose = curled(s, 0.3);
        pose.points[2].y() = bad;
        dynamics.step(kFrame, pose, goals);
        CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
        pose = curled(s, 0.3);
        pose.roll[1] = bad;
        dynamics.step(kFrame, pose, goals);
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
    }
    for (const double bad : {nan, infinite, -1.0}) {
        dynamics.step(bad, curled(s, 0.3), goals);
        CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
    }
    dynamics.step(kFrame, Pose{}, goals);
    CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
    const std::vector<IkGoal> elsewhere = {{0, Vec3::Zero()}, {99, Vec3::Zero()}, {-1, Vec3::Zero()}};
    dynamics.step(kFrame, curled(s, 0.3), elsewhere);
    CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
    CHECK(farthestFrom(dynamics.pose(), good) > 0.0);
    checkFinite(dynamics.pose());
}

TEST_CASE("bone dynamics: input that contradicts itself is refused with a reason") {
    const auto code = [](const BoneDynamics::Input& input) {
        const auto built = BoneDynamics::build(input);
        return built ? std::string("none") : built.error().code;
    };
    const auto good = inputOf(boneChain(3));
    CHECK(code(good) == "none");
    for (const double mass : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        auto input = good;
        input.mass[1] = mass;
        CHECK(code(input) == "bad-value");
    }
    auto input = good;
    input.mass.pop_back();
    CHECK(code(input) == "bad-value");
    for (const double hertz : {0.0, -1.0, 1001.0, std::numeric_limits<double>::quiet_NaN()}) {
        input = good;
        input.settings.springs[0].bendHertz = hertz;
        CHECK(code(input) == "bad-value");
    }
    input = good;
    input.settings.springs[0].stretchDamping = 11.0;
    CHECK(code(input) == "bad-value");
    input = good;
    input.settings.springs.resize(2);
    CHECK(code(input) == "bad-value");
    input = good;
    input.settings.ground = BoneDynamicsSettings::Ground{Plane(), -0.5};
    CHECK(code(input) == "bad-value");
    input = good;
    input.skeleton.bones.push_back({0, 3, -1, 3.0});
    CHECK(code(input) == "bone-loop");
    input = good;
    input.skeleton.bones[2].end = 9;
    CHECK(code(input) == "bad-place");
    auto dynamics = make(boneChain(3));
    auto settings = good.settings;
    settings.gravity.x() = std::numeric_limits<double>::quiet_NaN();
    CHECK(!dynamics.set(settings));
    settings.gravity.x() = 1.0;
    CHECK(dynamics.set(settings));
}

TEST_CASE("bone dynamics: steps do not allocate, and the same input gives the same bytes") {
    const Skeleton s = boneOctopus(4, 3);
    auto input = inputOf(s);
    input.settings.gravity = Vec3(0, -9.81, 0);
    input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.8), 0.4};
    auto one = BoneDynamics::build(input).value(), other = BoneDynamics::build(input).value();
    Pose pose = restPose(s);
    const std::vector<IkGoal> all = {{0, Vec3::Zero()}, {4, Vec3::Zero()}};
    std::size_t asked = 0;
    for (int i = 0; i < 120; ++i) {
        const std::span<const IkGoal> goals = std::span(all).first(i < 40 ? 1 : i < 80 ? 2 : 0);
        for (auto& p : pose.points) p.x() += 0.01 * std::sin(0.2 * i);
        pose.roll[5] = 0.01 * i;
        const std::size_t before = allocations();
        one.step(1.0 / 70.0, pose, goals);
        asked += allocations() - before;
        other.step(1.0 / 70.0, pose, goals);
        REQUIRE(farthestFrom(one.pose(), other.pose()) == 0.0);
    }
    CHECK(asked == 0);
}

TEST_CASE("bone dynamics: random bodies, drags, frame rates and limits: finite, bounded, and back to rest") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    const double hertz[] = {0.01, 0.5, 2.0, 10.0, 1000.0}, ratios[] = {0.0, 0.05, 0.5, 1.0, 10.0}, rates[] = {24, 30, 60, 90, 144, 1000};
    int rested = 0, scenes = 0;
    for (int scene = 0; scene < 24; ++scene) {
        CAPTURE(scene);
        const Skeleton s = scene % 2 ? randomTree(random, 7) : boneChain(4);
        auto input = inputOf(s);
        input.settings.springs.clear();
        const auto pick = [&](const auto& from) { return from[random() % std::size(from)]; };
        for (std::size_t b = 0; b < s.bones.size(); ++b)
            input.settings.springs.push_back({pick(hertz), pick(ratios), pick(hertz), pick(ratios), pick(hertz), pick(ratios)});
        for (double& m : input.mass) m = std::pow(10.0, 2.0 * d(random));
        input.settings.gravity = Vec3(0, -9.81 * (scene % 3), 0);
        if (scene % 4 == 1) input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-1.0), 0.4};
        auto dynamics = BoneDynamics::build(input).value();
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        std::vector<IkGoal> goals = {{0, s.points[0]}};
        for (int i = 0; i < 400; ++i) {
            if (i % 40 == 0) {
                goals.resize(1);
                for (int k = static_cast<int>(random() % 3); k > 0; --k) {
                    const int point = 1 + static_cast<int>(random() % (s.points.size() - 1));
                    goals.push_back({point, pose.points[point]});
                }
            }
            for (std::size_t k = 1; k < goals.size(); ++k) goals[k].target += 0.2 * Vec3(d(random), d(random), d(random));
            ik.solve(goals, pose);
            dynamics.step(1.0 / pick(rates), pose, goals);
            checkFinite(dynamics.pose());
            for (const auto& p : dynamics.pose().points) REQUIRE(p.norm() < 200.0);
            if (input.settings.ground)
                for (const auto& p : dynamics.pose().points) REQUIRE(p.y() >= -1.0 - 1e-6);
        }
        // Parameters of flesh: it comes to rest.
        input.settings.springs = {BoneSpring{}};
        REQUIRE(dynamics.set(input.settings));
        ++scenes;
        for (int i = 0; i < 1800 && !dynamics.resting(); ++i) dynamics.step(kFrame, pose, goals);
        rested += dynamics.resting();
        if (dynamics.resting() && input.settings.gravity.isZero() && !input.settings.ground) CHECK(farthestFrom(dynamics.pose(), pose) == 0.0);
    }
    CHECK(rested == scenes);
}

TEST_CASE("bone dynamics: limits of bend and twist are held within a degree or two while a loose chain swings, and energy is not made") {
    Skeleton s = boneChain(6), free = s;
    constexpr double kDegree = M_PI / 180.0;
    for (const int b : {2, 3}) s.bones[b].maxBend = 25.0 * kDegree;
    for (const int b : {1, 4}) s.bones[b].maxTwist = 50.0 * kDegree;
    BoneSpring loose;
    loose.bendHertz = loose.rollHertz = 0.8;
    loose.bendDamping = loose.rollDamping = 0.05;
    double bend[2] = {0.0, 0.0}, twist[2] = {0.0, 0.0}, step[2] = {0.0, 0.0};
    for (const bool limited : {false, true}) {
        const Skeleton& of = limited ? s : free;
        const BoneTree tree = boneTree(of);
        auto input = inputOf(of, loose);
        input.settings.gravity = Vec3(0, -3.0, 0);
        auto dynamics = BoneDynamics::build(input).value();
        const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
        Pose last = dynamics.pose();
        double energy = 0.0, most = 0.0, grown = 0.0;
        for (int i = 0; i < 900; ++i) {
            const Pose pose = curled(of, std::min(i, 600) * kFrame);
            if (i == 100) {
                const std::size_t had = allocations();
                dynamics.step(kFrame, pose, goals);
                CHECK(allocations() == had);
            } else {
                dynamics.step(kFrame, pose, goals);
            }
            const Pose& now = dynamics.pose();
            checkFinite(now);
            for (const int b : {2, 3}) {
                const Vec3 carried = now.frames[static_cast<std::size_t>(b - 1)] * tree.restDirection[static_cast<std::size_t>(b)];
                const Vec3 d = (now.points[static_cast<std::size_t>(b + 1)] - now.points[static_cast<std::size_t>(b)]).normalized();
                bend[limited] = std::max(bend[limited], std::atan2(carried.cross(d).norm(), carried.dot(d)) / kDegree);
            }
            for (const std::size_t b : {1u, 4u}) twist[limited] = std::max(twist[limited], std::abs(now.roll[b + 1] - now.roll[b]) / kDegree);
            if (i > 0) step[limited] = std::max(step[limited], farthestFrom(last, now));
            last = now;
            if (i > 601) grown = std::max(grown, dynamics.energy().total() - energy);
            energy = dynamics.energy().total();
            most = std::max(most, std::abs(energy));
        }
        // Left alone it loses energy: nothing feeds it.
        CHECK(grown <= 1e-9 * most);
    }
    MESSAGE("bends ", bend[1], " degrees (limit 25, without ", bend[0], "), twists ", twist[1], " (limit 50, without ", twist[0], "); largest step ", step[1], ", without ", step[0]);
    CHECK(bend[0] > 40.0);
    CHECK(twist[0] > 60.0);
    CHECK(bend[1] < 27.0);
    CHECK(twist[1] < 52.0);
    CHECK(step[1] < 1.5 * step[0]);
}
