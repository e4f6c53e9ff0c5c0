// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "core/character/deform_input.h"
#include "core/effects/ground_job.h"
#include "core/effects/touch_job.h"
#include "tests/character/random_characters.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

double lowest(const Character& c, const Vec3& down) {
    double found = 1e30;
    for (std::size_t e = 0; e < c.input().elements.size(); ++e) {
        const Points positions = c.positions(static_cast<int>(e));
        found = std::min(found, (positions * -down).minCoeff());
    }
    return found;
}

double lowestFlesh(const Character& c, const Vec3& down) {
    double found = 1e30;
    for (const FleshPoint& f : groundFlesh(c)) found = std::min(found, -down.dot(c.pose().points[static_cast<std::size_t>(f.point)] + f.offset));
    return found;
}

}  // namespace

TEST_CASE("ground: flesh that it watches is near the lowest vertex whatever lies below, in any pose, and where the character has it") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (int kind = 0; kind < 24; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        GroundEffect ground;
        ground.height = 1e9;  // none of it is far above
        input.effects.set(ground);
        auto c = Character::build(input).value();
        const double size = (input.skeleton.points.back() - input.skeleton.points.front()).norm() / static_cast<double>(input.elements.size());
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 6; ++frame) {
            for (int i = 0; i < 20; ++i) {
                const Vec3 down = Vec3(d(random), d(random), d(random)).normalized();
                // Elements are as high as wide. Directions are .25 radians apart, which misses 1 - cos(.15) of a radius, and what reaches less than .2 % of the diagonal
                // beyond is not taken: less than one per cent together at rest, and some more where an element is bent as none was when vertices were chosen.
                CHECK(lowestFlesh(c, down) - lowest(c, down) < 0.015 * size);
                CHECK(lowestFlesh(c, down) - lowest(c, down) > -1e-5 * size);
            }
            wander(c, random, pose);
            c.update(pose, 1.0 / 60.0);
        }
    }
}

TEST_CASE("ground: it sees the same flesh whoever deforms the elements, after a shape was shown too, and its frames do not allocate") {
    std::mt19937 random(4);
    for (int kind = 0; kind < 16; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        GroundEffect ground;
        ground.height = 1e9;
        input.effects.set(ground);
        auto here = Character::build(input).value(), there = Character::build(input).value();
        (void)there.deformInput();
        for (int e = 0; e < static_cast<int>(input.elements.size()); ++e) (void)there.deformExternally(e, true);
        Pose pose = restPose(input.skeleton);
        const auto same = [&] {
            return std::equal(groundFlesh(here).begin(), groundFlesh(here).end(), groundFlesh(there).begin(), groundFlesh(there).end(),
                              [](const FleshPoint& a, const FleshPoint& b) { return a.point == b.point && a.bone == b.bone && a.offset == b.offset; });
        };
        std::vector<double> shape(static_cast<std::size_t>(here.shapeLayout().size()));
        there.shape(shape.data());
        for (int frame = 0; frame < 5; ++frame) {
            wander(here, random, pose);
            here.update(pose, 1.0 / 60.0);
            const auto before = allocations();
            there.update(pose, 1.0 / 60.0);
            CHECK(allocations() == before);
            CHECK(same());
        }
        there.show(shape.data());
        here.update(pose);
        there.update(pose);
        CHECK(same());
    }
}

TEST_CASE("ground: far above it flesh is not evaluated, and is seen above it") {
    CharacterInput input = caterpillar::make({});
    GroundEffect ground;
    ground.height = -100.0;
    input.effects.set(ground);
    auto c = Character::build(input).value();
    CHECK(lowestFlesh(c, -Vec3::UnitY()) > -1.0);
    ground.height = -0.6;
    CharacterEffects near;
    near.set(ground);
    c.tune(near);
    c.update(restPose(input.skeleton));
    CHECK(lowestFlesh(c, -Vec3::UnitY()) == doctest::Approx(lowest(c, -Vec3::UnitY())).epsilon(1e-3));
}

TEST_CASE("ground: flesh that is warped and stretched into it is seen in it, however high its middle is") {
    CharacterInput input = caterpillar::make({});
    input.effects.set(BendWarpEffect{});
    Pose pose = restPose(input.skeleton);
    const Eigen::Quaterniond upright(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));
    for (Vec3& p : pose.points) p = upright * (4.0 * p);
    for (Eigen::Quaterniond& frame : pose.frames) frame = upright * frame;
    auto above = Character::build(input).value();
    above.update(pose);
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        CAPTURE(e);
        GroundEffect ground;
        ground.height = above.positions(static_cast<int>(e)).col(1).minCoeff() + 0.2;
        input.effects.set(ground);
        auto c = Character::build(input).value();
        c.update(pose);
        CHECK(groundDepths(c)[e].depth == doctest::Approx(0.2).epsilon(1e-4));
    }
}

TEST_CASE("ground: a landing is as hard as it is fast, at any rate, and what lies, slides or rises does not land") {
    for (const double rate : {60.0, 240.0}) {
        CAPTURE(rate);
        CharacterInput input = caterpillar::make({});
        Vec3 low = Vec3::Constant(1e30), high = -low;
        for (const auto& element : input.elements) {
            low = low.cwiseMin(element.mesh->body.vertices.colwise().minCoeff().transpose());
            high = high.cwiseMax(element.mesh->body.vertices.colwise().maxCoeff().transpose());
        }
        const double size = (high - low).norm(), whole = std::sqrt(9.81 * size);  // of a fall from half the size: v^2 = 2 g size / 2
        GroundEffect ground;
        ground.height = low.y() - 0.2 * size;
        input.effects.set(ground);
        auto c = Character::build(input).value();
        Pose pose = restPose(input.skeleton);
        double height = 0.2 * size;
        const auto frame = [&](double speed, double aside = 0.0) {
            for (Vec3& p : pose.points) p += Vec3(aside, speed, 0.0) / rate;
            height += speed / rate;
            c.update(pose, 1.0 / rate);
            return groundLanding(c);
        };
        CHECK(frame(0.0) == 0.0);
        for (const double part : {0.1, 0.5, 3.0}) {
            CAPTURE(part);
            double hardest = 0.0;
            while (height > 0.0) hardest = std::max(hardest, frame(-part * whole));
            CHECK(hardest == doctest::Approx(std::min(1.0, part)).epsilon(1e-3));
            CHECK(frame(0.0) == 0.0);
            CHECK(frame(0.0, 0.5 * whole) == 0.0);
            while (height < 0.2 * size) CHECK(frame(whole) == 0.0);
        }
        // So slowly that nobody would feel it.
        while (height > 0.0) CHECK(frame(-0.03 * whole) == 0.0);
    }
}

TEST_CASE("ground: where a whole character is shifted out of it, flesh of any kind moves as far as its bones do") {
    std::mt19937 random(5);
    for (int kind = 0; kind < 32; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        const double size = (input.skeleton.points.back() - input.skeleton.points.front()).norm() / static_cast<double>(input.elements.size());
        GroundEffect ground;
        ground.height = -0.5 * size;  // some of it lies on it
        input.effects.set(ground);
        auto c = Character::build(input).value();
        const Vec3 at = input.elements[0].mesh->body.vertices.row(0).transpose(), shift(0.0, 0.3 * size, 0.0);
        (void)setFinger(c, 0, 0, at, 0.8 * at, 0.0);
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 6; ++frame) {
            if (frame == 4) liftFinger(c, 0, 0);
            wander(c, random, pose);
            c.update(pose, 1.0 / 60.0);
            std::vector<Points> before;
            for (std::size_t e = 0; e < input.elements.size(); ++e) before.push_back(c.positions(static_cast<int>(e)));
            Pose shifted = pose;
            for (Vec3& p : shifted.points) p += shift;
            c.shift(shifted);
            for (std::size_t e = 0; e < input.elements.size(); ++e)
                CHECK((c.positions(static_cast<int>(e)).rowwise() - shift.transpose() - before[e]).cwiseAbs().maxCoeff() <= 1e-5 * size);
        }
    }
}
