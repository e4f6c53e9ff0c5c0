// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "tests/dynamics/bones.h"

using namespace imomushi;

TEST_CASE("bone dynamics: gravity bends what is held by as much as its springs say, and what is free falls as a stone does") {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.bendHertz = 2.0, spring.bendDamping = 1.0, spring.stretchHertz = 100.0;
    auto input = inputOf(s, spring);
    input.settings.gravity = Vec3(0, -9.81, 0);
    auto dynamics = BoneDynamics::build(input).value();
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    for (int i = 0; i < 600; ++i) dynamics.step(kFrame, restPose(s), goals);
    CHECK(dynamics.resting());
    // omega^2 theta = g cos theta for a bone of 1 m.
    double angle = 0.0;
    for (int i = 0; i < 100; ++i) angle = 9.81 * std::cos(angle) / std::pow(2.0 * M_PI * 2.0, 2);
    CHECK(std::atan2(-dynamics.pose().points[1].y(), dynamics.pose().points[1].x()) == doctest::Approx(angle).epsilon(1e-3));

    input.settings.returnHertz = 0.0;
    auto falling = BoneDynamics::build(input).value();
    for (int i = 0; i < 60; ++i) falling.step(kFrame, restPose(s), {});
    for (const auto& p : falling.pose().points) CHECK(p.y() == doctest::Approx(-0.5 * 9.81).epsilon(1e-6));
}

TEST_CASE("bone dynamics: bodies fall on the ground, never through it, and come to rest there without jitter") {
    for (const double friction : {0.0, 0.3, 2.0})
        for (const Skeleton& s : {boneChain(5), boneOctopus(5, 3)}) {
            CAPTURE(friction);
            CAPTURE(s.bones.size());
            auto input = inputOf(s);
            input.settings.gravity = Vec3(0, -9.81, 0);
            input.settings.returnHertz = 0.0;
            input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-2.0), friction};
            auto dynamics = BoneDynamics::build(input).value();
            Pose start = restPose(s);
            const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Vec3(1, 0, 1).normalized()));
            for (auto& p : start.points) p = turn * p;
            for (auto& q : start.frames) q = turn * q;
            dynamics.reset(start);
            int frames = 0;
            double lowest = 0.0;
            for (; frames < 1800 && !dynamics.resting(); ++frames) {
                dynamics.step(kFrame, start, {});
                for (const auto& p : dynamics.pose().points) lowest = std::min(lowest, p.y() + 2.0);
            }
            CHECK(lowest >= -1e-6);
            CHECK(dynamics.resting());
            checkFinite(dynamics.pose());
        }
}

TEST_CASE("bone dynamics: a fall looks the same at any frame rate") {
    const Skeleton s = boneOctopus(4, 3);
    std::vector<Pose> seen;
    for (const int rate : {30, 60, 144}) {
        auto input = inputOf(s);
        input.settings.gravity = Vec3(0, -9.81, 0);
        input.settings.returnHertz = 0.0;
        input.settings.ground = BoneDynamicsSettings::Ground{Plane::through(Vec3(0, -1, 0), Vec3(0.2, 1, 0)).value(), 0.3};
        auto dynamics = BoneDynamics::build(input).value();
        for (int i = 0; i < rate; ++i) dynamics.step(1.0 / rate, restPose(s), {});
        seen.push_back(dynamics.pose());
    }
    CHECK(farthestFrom(seen[0], restPose(s)) > 0.5);
    CHECK(farthestFrom(seen[0], seen[1]) < 1e-9);
    CHECK(farthestFrom(seen[0], seen[2]) < 1e-9);
}

TEST_CASE("bone dynamics: a body on a slope stays where friction is strong and slides where it is weak") {
    const Skeleton s = boneChain(2);
    for (const double friction : {0.2, 0.9}) {
        auto input = inputOf(s);
        input.settings.gravity = Vec3(0, -9.81, 0);
        input.settings.returnHertz = 0.0;
        input.settings.ground = BoneDynamicsSettings::Ground{Plane::through(Vec3::Zero(), Vec3(0, std::cos(0.5), -std::sin(0.5))).value(), friction};  // tan .5 = .55
        auto dynamics = BoneDynamics::build(input).value();
        for (int i = 0; i < 60; ++i) dynamics.step(kFrame, restPose(s), {});
        const double speed = dynamics.velocities()[1].norm(), moved = (dynamics.pose().points[1] - s.points[1]).norm();
        if (friction > 0.6) {
            CHECK(speed == 0.0);
            CHECK(moved < 1e-3);
            CHECK(dynamics.resting());
        } else {
            const double acceleration = 9.81 * (std::sin(0.5) - friction * std::cos(0.5));
            CHECK(speed == doctest::Approx(acceleration).epsilon(0.03));
            CHECK(moved == doctest::Approx(0.5 * acceleration).epsilon(0.03));
        }
    }
}

TEST_CASE("bone dynamics: a ground that rises lifts what lies on it, one that sinks lets it fall") {
    const Skeleton s = boneChain(3);
    auto input = inputOf(s);
    input.settings.gravity = Vec3(0, -9.81, 0);
    input.settings.returnHertz = 0.0;
    input.settings.ground = BoneDynamicsSettings::Ground{Plane(), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    for (int i = 0; i < 60; ++i) dynamics.step(kFrame, restPose(s), {});
    REQUIRE(dynamics.resting());
    input.settings.ground->plane = Plane::level(0.1);
    REQUIRE(dynamics.set(input.settings));
    dynamics.step(kFrame, restPose(s), {});
    for (const auto& p : dynamics.pose().points) CHECK(p.y() >= 0.1 - 1e-6);
    input.settings.ground->plane = Plane::level(-5.0);
    REQUIRE(dynamics.set(input.settings));
    const double before = dynamics.pose().points[0].y();
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, restPose(s), {});
    for (const auto& p : dynamics.pose().points) CHECK(before - p.y() == doctest::Approx(0.5 * 9.81 * 0.25).epsilon(0.05));
}

TEST_CASE("bone dynamics: held points stay above the ground, too") {
    const Skeleton s = boneChain(3);
    auto input = inputOf(s);
    input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.2), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    Pose pose = restPose(s);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {3, Vec3::Zero()}};
    for (int i = 0; i < 60; ++i) {
        pose.points[3].y() -= 0.02;
        dynamics.step(kFrame, pose, goals);
        for (const auto& p : dynamics.pose().points) CHECK(p.y() >= -0.2 - 1e-6);
    }
    CHECK(dynamics.pose().points[3].y() == doctest::Approx(-0.2));
}
