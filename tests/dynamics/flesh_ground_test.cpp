// SPDX-License-Identifier: GPL-3.0-or-later
// Flesh around bones that the ground holds, here as rigid as its bones are: how it is lifted, carried and let go.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/dynamics/bones.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

/// A drop of flesh below each joint point, and a head that reaches `lever` bones beyond the last one.
std::vector<FleshPoint> fleshOf(const Skeleton& s, double radius, double lever) {
    std::vector<FleshPoint> flesh;
    const int bones = static_cast<int>(s.bones.size());
    for (int i = 0; i <= bones; ++i) flesh.push_back({i, std::min(i, bones - 1), 0.0, Vec3(0.0, -radius, 0.0)});
    flesh.push_back({bones, bones - 1, lever, Vec3(lever * s.bones.back().length, 0.0, 0.0)});
    return flesh;
}

/// As it turns with its bones from rest.
std::vector<FleshPoint> shown(const Skeleton& s, std::vector<FleshPoint> flesh, const Pose& pose) {
    const BoneTree tree = boneTree(s);
    for (FleshPoint& f : flesh) {
        const auto& bone = s.bones[static_cast<std::size_t>(f.bone)];
        const Vec3 along = pose.points[static_cast<std::size_t>(bone.end)] - pose.points[static_cast<std::size_t>(bone.start)];
        f.offset = minimalRotation(tree.restDirection[static_cast<std::size_t>(f.bone)], along.normalized()) * f.offset;
    }
    return flesh;
}

double lowest(const std::vector<FleshPoint>& flesh, const Pose& pose, double level) {
    double found = 1e30;
    for (const FleshPoint& f : flesh) found = std::min(found, (pose.points[static_cast<std::size_t>(f.point)] + f.offset).y() - level);
    return found;
}

}  // namespace

TEST_CASE("flesh on the ground: bones are lifted until the lowest flesh around each lies on it, however far that reaches beyond its bone") {
    const Skeleton s = boneChain(3);
    for (const double lever : {0.0, 0.5, 3.0}) {
        CAPTURE(lever);
        FleshClearance clearance(s);
        const auto flesh = fleshOf(s, 0.3, lever);
        clearance.see(flesh, s.points);
        Pose pose = restPose(s);
        pose.points[3].y() -= 1.0;
        std::vector<double> kept(s.points.size());
        clearance.raise(pose.points, Plane::level(0.0), kept);
        // Each of the rounds leaves less than lever / (1 + lever) of what a head is from where it belongs: here 10 % after eight, on the safe side of the plane or below it.
        CHECK(lowest(shown(s, flesh, pose), pose, 0.0) > -0.1);
        CHECK(pose.points[0].y() == doctest::Approx(0.3));
        clearance.see(shown(s, flesh, pose), pose.points);
        CHECK(clearance.depth(Plane::level(-100.0)) == 0.0);
    }
}

TEST_CASE("flesh on the ground: what falls on it comes to rest on its flesh, sleeps, and wakes when the flesh comes to lie deeper or higher") {
    const Skeleton s = boneChain(4);
    for (const double lever : {0.0, 0.5, 3.0}) {
        CAPTURE(lever);
        auto input = inputOf(s);
        input.settings.gravity = Vec3(0, -9.81, 0);
        input.settings.returnHertz = 0.0;
        input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-2.0), 0.5};
        auto dynamics = BoneDynamics::build(input).value();
        double radius = 0.3;
        const auto frames = [&](int count) {
            double found = 1e30;
            for (int i = 0; i < count; ++i) {
                dynamics.step(kFrame, restPose(s), {});
                const auto flesh = shown(s, fleshOf(s, radius, lever), dynamics.pose());
                found = std::min(found, lowest(flesh, dynamics.pose(), -2.0));
                dynamics.seeFlesh(flesh, dynamics.pose().points);
            }
            return found;
        };
        dynamics.seeFlesh(fleshOf(s, radius, lever), s.points);
        CHECK(frames(600) > -1e-3);
        REQUIRE(dynamics.resting());
        CHECK(std::abs(frames(1)) < 1e-4);
        const auto before = dynamics.pose().points;
        frames(10);
        CHECK(dynamics.pose().points == before);
        for (const double other : {0.4, 0.25}) {
            radius = other;
            frames(1);
            CHECK_FALSE(dynamics.resting());
            frames(600);
            CHECK(dynamics.resting());
            CHECK(std::abs(frames(1)) < 1e-4);
            CHECK(dynamics.pose().points[0].y() == doctest::Approx(-2.0 + other).epsilon(1e-4));
        }
    }
}

TEST_CASE("flesh on the ground: the ground wins over a held point and says so, also while all rests") {
    const Skeleton s = boneChain(3);
    auto input = inputOf(s);
    input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.5), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    const auto flesh = fleshOf(s, 0.3, 0.5);
    dynamics.seeFlesh(flesh, s.points);
    Pose pose = restPose(s);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {3, Vec3::Zero()}};
    const auto says = [&] { return dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::HeldByGround); };
    const auto frame = [&] {
        dynamics.step(kFrame, pose, goals);
        dynamics.seeFlesh(shown(s, flesh, dynamics.pose()), dynamics.pose().points);
    };
    for (int i = 0; i < 120; ++i) {
        if (i < 60) pose.points[3].y() -= 0.02;
        frame();
        CHECK(lowest(shown(s, flesh, dynamics.pose()), dynamics.pose(), -0.5) > -0.02);  // of a bone of 1 m
    }
    CHECK(says());
    for (int i = 0; i < 600 && !dynamics.resting(); ++i) frame();
    CHECK(dynamics.resting());
    frame();
    CHECK(says());
    CHECK(std::abs(lowest(shown(s, flesh, dynamics.pose()), dynamics.pose(), -0.5)) < 1e-4);
    pose = restPose(s);
    for (int i = 0; i < 120; ++i) frame();
    CHECK(dynamics.warnings() == 0);
}

TEST_CASE("flesh on the ground: frames with flesh do not allocate") {
    const Skeleton s = boneChain(6);
    auto input = inputOf(s);
    input.settings.gravity = Vec3(0, -9.81, 0);
    input.settings.returnHertz = 0.0;
    input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.5), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    const auto flesh = fleshOf(s, 0.2, 0.5);
    dynamics.seeFlesh(flesh, s.points);
    const Pose pose = restPose(s);
    const auto before = allocations();
    for (int i = 0; i < 120; ++i) {
        dynamics.step(kFrame, pose, {});
        dynamics.seeFlesh(flesh, dynamics.pose().points);
    }
    CHECK(allocations() == before);
}
