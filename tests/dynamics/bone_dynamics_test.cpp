// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/skeleton/bone_tree.h"
#include "core/skeleton/inverse_kinematics.h"
#include "tests/dynamics/skeletons.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

BoneDynamics::Input inputOf(const Skeleton& s, const BoneSpring& spring = {}) {
    BoneDynamics::Input input;
    input.skeleton = s;
    input.mass.assign(s.points.size(), 1.0);
    input.settings.springs = {spring};
    return input;
}

BoneDynamics make(const Skeleton& s, const BoneSpring& spring = {}) { return BoneDynamics::build(inputOf(s, spring)).value(); }

double farthestFrom(const Pose& a, const Pose& b) {
    double m = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i) m = std::max(m, (a.points[i] - b.points[i]).norm());
    return m;
}

void checkFinite(const Pose& pose) {
    for (const auto& p : pose.points) REQUIRE(allFinite(p));
    for (const auto& q : pose.frames) REQUIRE(allFinite(q.coeffs()));
    for (const double r : pose.roll) REQUIRE(std::isfinite(r));
}

// Hertz and damping ratio of a free swing about zero, from where it crosses zero upwards and how far it goes between.
struct Swinging {
    double hertz = 0.0, damping = 0.0;
};
Swinging measure(const std::vector<double>& signal, double dt) {
    std::vector<double> crossings, extremes;
    double most = 0.0;
    for (std::size_t i = 1; i < signal.size(); ++i) {
        most = std::max(most, std::abs(signal[i]));
        if (signal[i - 1] < 0.0 && signal[i] >= 0.0) {
            crossings.push_back((static_cast<double>(i) - signal[i] / (signal[i] - signal[i - 1])) * dt);
            extremes.push_back(most);
            most = 0.0;
        }
    }
    REQUIRE(crossings.size() >= 3);
    const std::size_t n = crossings.size();
    const double period = (crossings[n - 1] - crossings[0]) / static_cast<double>(n - 1);
    const double decrement = std::log(extremes[1] / extremes[n - 1]) / static_cast<double>(n - 2);
    const double ratio = decrement / std::hypot(2.0 * M_PI, decrement);
    return {1.0 / period / std::sqrt(1.0 - ratio * ratio), ratio};
}

constexpr double kFrame = 1.0 / 60.0;

}  // namespace

TEST_CASE("bone dynamics: a swinging bone has the frequency and damping that were asked for, at small and large angles") {
    const Skeleton s = boneChain(1);
    for (const double hertz : {0.3, 2.0, 8.0})
        for (const double damping : {0.02, 0.1, 0.3})
            for (const double angle : {0.05, 1.5}) {
                CAPTURE(hertz);
                CAPTURE(damping);
                CAPTURE(angle);
                BoneSpring spring;
                spring.bendHertz = hertz;
                spring.bendDamping = damping;
                spring.stretchHertz = 1000.0;  // it keeps its length
                spring.stretchDamping = 1.0;
                auto dynamics = make(s, spring);
                Pose bent = restPose(s);
                bent.points[1] = Vec3(std::cos(angle), std::sin(angle), 0);
                const std::vector<Hold> holds = {{0, Vec3::Zero()}};
                dynamics.step(kFrame, restPose(s), holds);
                dynamics.reset(bent);
                std::vector<double> signal;
                const double dt = 0.02 / hertz;
                // From `bent` the kinematic pose jumps to rest within the first frame.
                for (int i = 0; i < 250; ++i) {
                    dynamics.step(i == 0 ? 1e-4 : dt, restPose(s), holds);
                    signal.push_back(std::atan2(dynamics.pose().points[1].y(), dynamics.pose().points[1].x()));
                }
                const auto seen = measure(signal, dt);
                CHECK(seen.hertz == doctest::Approx(hertz).epsilon(0.02));
                CHECK(seen.damping == doctest::Approx(damping).epsilon(0.02));
            }
}

TEST_CASE("bone dynamics: a bone swings at its frequency with all that hangs on it, from whichever end it is held") {
    const Skeleton s = boneChain(4);
    for (const bool fromEnd : {false, true}) {
        auto input = inputOf(s);
        BoneSpring stiff, soft;
        stiff.stretchHertz = stiff.bendHertz = 300.0, stiff.stretchDamping = stiff.bendDamping = 1.0;
        soft = stiff;
        soft.bendHertz = 1.0, soft.bendDamping = 0.05;
        input.settings.springs.assign(4, stiff);
        input.settings.springs[fromEnd ? 2 : 0] = soft;
        for (std::size_t i = 0; i < input.mass.size(); ++i) input.mass[i] = 1.0 + static_cast<double>(i * i);
        auto dynamics = BoneDynamics::build(input).value();
        const int at = fromEnd ? 4 : 0, pivot = fromEnd ? 2 : 0, tip = 4 - at;
        const std::vector<Hold> holds = {{at, Vec3::Zero()}};
        dynamics.step(kFrame, restPose(s), holds);
        Pose turned = restPose(s);
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3(0, 1, 1).normalized()));
        for (int i = tip; i != pivot; i += fromEnd ? 1 : -1) turned.points[i] = s.points[pivot] + turn * (s.points[i] - s.points[pivot]);
        dynamics.reset(turned);
        std::vector<double> signal;
        for (int i = 0; i < 600; ++i) {
            dynamics.step(i == 0 ? 1e-4 : 0.01, restPose(s), holds);
            signal.push_back(dynamics.pose().points[tip].y());
        }
        const auto seen = measure(signal, 0.01);
        CHECK(seen.hertz == doctest::Approx(1.0).epsilon(0.02));
        CHECK(seen.damping == doctest::Approx(0.05).epsilon(0.03));
    }
}

TEST_CASE("bone dynamics: a stretching bone has the frequency and damping that were asked for, at small and large strains") {
    const Skeleton s = boneChain(1);
    for (const double hertz : {0.3, 2.0, 8.0})
        for (const double damping : {0.02, 0.1, 0.3})
            for (const double strain : {0.05, 0.3}) {
                CAPTURE(hertz);
                CAPTURE(damping);
                CAPTURE(strain);
                BoneSpring spring;
                spring.stretchHertz = hertz;
                spring.stretchDamping = damping;
                auto dynamics = make(s, spring);
                Pose longer = restPose(s);
                longer.points[1].x() = 1.0 + strain;
                const std::vector<Hold> holds = {{0, Vec3::Zero()}};
                dynamics.step(kFrame, restPose(s), holds);
                dynamics.reset(longer);
                std::vector<double> signal;
                const double dt = 0.02 / hertz;
                for (int i = 0; i < 250; ++i) {
                    dynamics.step(i == 0 ? 1e-4 : dt, restPose(s), holds);
                    const double r = dynamics.pose().points[1].x();
                    signal.push_back(0.5 * (r - 1.0 / r));  // harmonic in energy
                }
                const auto seen = measure(signal, dt);
                CHECK(seen.hertz == doctest::Approx(hertz).epsilon(0.02));
                CHECK(seen.damping == doctest::Approx(damping).epsilon(strain > 0.1 ? 0.1 : 0.02));
            }
}

TEST_CASE("bone dynamics: a pose that rests is kept, bit for bit, and sleeps") {
    const Skeleton s = boneOctopus(8, 4);
    auto dynamics = make(s);
    const std::vector<Hold> holds = {{0, s.points[0]}};
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, restPose(s), holds);
    CHECK(dynamics.resting());
    CHECK(farthestFrom(dynamics.pose(), restPose(s)) == 0.0);
    CHECK(dynamics.warnings() == 0u);
}

TEST_CASE("bone dynamics: after a drag the body swings past, comes to the kinematic pose exactly, and sleeps") {
    for (const Skeleton& s : {boneChain(5), boneOctopus(8, 4)}) {
        auto dynamics = make(s);
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        const int last = static_cast<int>(s.points.size()) - 1;
        std::vector<Hold> holds = {{0, s.points[0]}, {last, s.points[last]}};
        double overshoot = 0.0;
        int frames = 0;
        for (; frames < 3000 && !dynamics.resting(); ++frames) {
            holds[1].target = s.points[last] + std::min(frames / 10.0, 1.0) * Vec3(-0.3, 0.5, 0.4);
            ik.solve(holds, pose);
            dynamics.step(kFrame, pose, holds);
            overshoot = std::max(overshoot, farthestFrom(dynamics.pose(), pose));
        }
        CHECK(overshoot > 0.02);
        CHECK(frames < 1200);
        REQUIRE(dynamics.resting());
        CHECK(farthestFrom(dynamics.pose(), pose) == 0.0);
    }
}

namespace {

// A chain that is carried about and curled by a hand that knows no frames: its kinematic pose at a time.
Pose curled(const Skeleton& s, double time) {
    Pose pose = restPose(s);
    const BoneTree tree = boneTree(s);
    pose.points[0] = Vec3(0.5 * std::sin(4.0 * time), 0.3 * std::sin(6.0 * time), 0.0);
    const double bend = 0.35 * std::sin(5.0 * time), twist = 0.8 * std::sin(3.0 * time);
    Eigen::Quaterniond frame(Eigen::AngleAxisd(0.4 * std::sin(2.0 * time), Vec3::UnitY()));
    for (std::size_t b = 0; b < s.bones.size(); ++b) {
        frame = frame * Eigen::Quaterniond(Eigen::AngleAxisd(bend, Vec3::UnitZ()));
        pose.frames[b] = frame;
        const double length = s.bones[b].length * (1.0 + 0.1 * std::sin(7.0 * time));
        pose.points[b + 1] = pose.points[b] + length * (frame * tree.restDirection[b]);
        pose.roll[b + 1] = twist * static_cast<double>(b + 1);
    }
    return pose;
}

}  // namespace

TEST_CASE("bone dynamics: a chain dragged along a path moves alike at 30, 60, 144 and uneven frames per second") {
    const Skeleton s = boneChain(5);
    BoneSpring spring;
    spring.bendHertz = 1.5;
    spring.bendDamping = 0.15;
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    std::vector<std::vector<Pose>> seen;
    std::mt19937 random(3);
    for (const int rate : {600, 30, 60, 144, 0}) {
        auto dynamics = make(s, spring);
        dynamics.reset(curled(s, 0.0));
        std::vector<Pose> poses;
        for (int sixth = 0; sixth < 24; ++sixth) {
            const int frames = rate ? rate / 6 : 7;
            double time = 0.0;
            for (int i = 0; i < frames; ++i) {
                const double uneven = rate ? 1.0 / frames : i + 1 < frames ? (0.5 + static_cast<double>(random() % 1000) * 1e-3) / frames * 0.9 : 1.0 - time;
                time += uneven;
                dynamics.step(uneven / 6.0, curled(s, (sixth + time) / 6.0), holds);
            }
            poses.push_back(dynamics.pose());
        }
        seen.push_back(poses);
    }
    double amplitude = 0.0, rollAmplitude = 0.0;
    for (int k = 0; k < 24; ++k) {
        amplitude = std::max(amplitude, farthestFrom(seen[0][k], curled(s, (k + 1) / 6.0)));
        rollAmplitude = std::max(rollAmplitude, std::abs(seen[0][k].roll[5] - curled(s, (k + 1) / 6.0).roll[5]));
    }
    CHECK(amplitude > 0.3);
    CHECK(rollAmplitude > 0.1);
    for (std::size_t r = 1; r < seen.size(); ++r) {
        double worst = 0.0, roll = 0.0;
        for (int k = 0; k < 24; ++k) {
            worst = std::max(worst, farthestFrom(seen[0][k], seen[r][k]));
            roll = std::max(roll, std::abs(seen[0][k].roll[5] - seen[r][k].roll[5]));
        }
        CAPTURE(r);
        CHECK(worst < 0.02 * amplitude);
        CHECK(roll < 0.02 * rollAmplitude);
    }
}

TEST_CASE("bone dynamics: strong dampers take a bone along at once: after a start of its hold it lags by speed / (2 ratio omega)") {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.bendHertz = 0.5, spring.bendDamping = 10.0;
    auto dynamics = make(s, spring);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    Pose pose = restPose(s);
    dynamics.step(kFrame, pose, holds);
    const double speed = 0.2;
    for (int i = 0; i < 15; ++i) {
        for (auto& p : pose.points) p.y() += speed * kFrame;
        dynamics.step(kFrame, pose, holds);
    }
    // y'' = -2 ratio omega y' from y' = -speed, the spring being weak: 1 % of the return in this quarter of a second.
    const double lag = pose.points[1].y() - dynamics.pose().points[1].y();
    CHECK(lag == doctest::Approx(speed / (2.0 * 10.0 * 2.0 * M_PI * 0.5)).epsilon(0.05));
}

TEST_CASE("bone dynamics: bones that are stiff to the eye follow the kinematic pose") {
    const Skeleton s = boneChain(5);
    BoneSpring rigid;
    rigid.stretchHertz = rigid.bendHertz = rigid.rollHertz = BoneSpring::kMostHertz;
    rigid.stretchDamping = rigid.bendDamping = rigid.rollDamping = 1.0;
    auto dynamics = make(s, rigid);
    dynamics.reset(curled(s, 0.0));
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    double away = 0.0, roll = 0.0, turn = 0.0;
    for (int i = 1; i <= 240; ++i) {
        const Pose kinematic = curled(s, i * kFrame);
        dynamics.step(kFrame, kinematic, holds);
        away = std::max(away, farthestFrom(dynamics.pose(), kinematic));
        for (int p = 0; p <= 5; ++p) roll = std::max(roll, std::abs(dynamics.pose().roll[p] - kinematic.roll[p]));
        for (int b = 0; b < 5; ++b) turn = std::max(turn, dynamics.pose().frames[b].angularDistance(kinematic.frames[b]));
    }
    CHECK(away < 1e-4 * 5.0);
    CHECK(roll < 1e-3);
    CHECK(turn < 1e-3);
}

TEST_CASE("bone dynamics: energy never grows while nothing outside moves, whatever the parameters") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    const auto any = [&](double low, double high) { return low * std::pow(high / low, 0.5 * (d(random) + 1.0)); };
    for (int scene = 0; scene < 60; ++scene) {
        const Skeleton s = scene % 3 == 0 ? boneChain(6) : randomTree(random, 8);
        auto input = inputOf(s);
        input.settings.springs.clear();
        for (std::size_t b = 0; b < s.bones.size(); ++b)
            input.settings.springs.push_back({any(0.01, 1000), std::max(d(random), 0.0), any(0.01, 1000), std::max(d(random), 0.0), 1.0, 0.1});
        for (double& m : input.mass) m = any(1e-3, 10.0);
        if (scene % 2) input.settings.gravity = Vec3(0, -9.81, 0);
        if (scene % 4 == 3) input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -1.5, 0), Vec3(0.1, 1, 0), 0.5};
        if (scene % 5 == 4) input.settings.returnHertz = 0.0;
        auto dynamics = BoneDynamics::build(input).value();
        Pose wild = restPose(s);
        for (auto& p : wild.points) p += Vec3(d(random), d(random), d(random));
        std::vector<Hold> holds;
        if (scene % 5 != 4) holds.push_back({0, Vec3::Zero()});
        dynamics.step(kFrame, restPose(s), holds);
        dynamics.reset(wild);
        // The kinematic pose jumps to rest, and the held point comes home.
        for (int i = 0; i < 200; ++i) dynamics.step(0.01, restPose(s), holds);
        double before = dynamics.energy().total();
        const double first = before;
        double weight = 0.0;
        for (const double m : input.mass) weight += m * input.settings.gravity.norm();
        for (int i = 0; i < 300; ++i) {
            dynamics.step(1.0 / 97.0, restPose(s), holds);
            const double now = dynamics.energy().total();
            CAPTURE(scene);
            CAPTURE(i);
            const auto e = dynamics.energy();
            REQUIRE(now <= before + 1e-12 * (e.kinetic + e.elastic + std::abs(e.gravity) + weight * 10.0));
            before = now;
        }
        checkFinite(dynamics.pose());
        CHECK(before <= first + 1e-10 * (std::abs(first) + weight * 10.0));
    }
}

TEST_CASE("bone dynamics: what swings without damping keeps its energy") {
    const Skeleton s = boneChain(3);
    BoneSpring spring;
    spring.stretchHertz = 4.0, spring.stretchDamping = 0.0, spring.bendHertz = 1.5, spring.bendDamping = 0.0;
    auto dynamics = make(s, spring);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    Pose bent = restPose(s);
    bent.points[3] += Vec3(-0.2, 0.6, 0.3);
    dynamics.step(kFrame, restPose(s), holds);
    dynamics.reset(bent);
    for (int i = 0; i < 2; ++i) dynamics.step(0.01, restPose(s), holds);  // the kinematic pose jumps to rest
    const double first = dynamics.energy().total();
    REQUIRE(first > 0.0);
    for (int i = 0; i < 300; ++i) dynamics.step(kFrame, restPose(s), holds);
    CHECK(dynamics.energy().total() > 0.98 * first);
}

TEST_CASE("bone dynamics: a body that nothing holds keeps its momentum, a straight one also its angular momentum") {
    for (const Skeleton& s : {boneChain(4), boneOctopus(3, 2)}) {
        auto input = inputOf(s);
        input.settings.returnHertz = 0.0;
        for (std::size_t i = 0; i < input.mass.size(); ++i) input.mass[i] = 0.5 + 0.3 * static_cast<double>(i);
        auto dynamics = BoneDynamics::build(input).value();
        // Thrown: a hand moves one point and lets go.
        Pose pose = restPose(s);
        const std::vector<Hold> holds = {{0, s.points[0]}};
        for (int i = 0; i < 12; ++i) {
            for (auto& p : pose.points) p += Vec3(0.03, 0.05, 0.02);
            dynamics.step(kFrame, pose, holds);
        }
        pose = restPose(s);
        for (int i = 0; i < 2; ++i) dynamics.step(kFrame, pose, {});
        const auto momentum = [&] {
            Vec3 p = Vec3::Zero(), l = Vec3::Zero();
            for (std::size_t i = 0; i < input.mass.size(); ++i) {
                p += input.mass[i] * dynamics.velocities()[i];
                l += input.mass[i] * dynamics.pose().points[i].cross(dynamics.velocities()[i]);
            }
            return std::pair(p, l);
        };
        const auto [p0, l0] = momentum();
        REQUIRE(p0.norm() > 0.1);
        REQUIRE(l0.norm() > 0.1);
        for (int i = 0; i < 240; ++i) dynamics.step(kFrame, pose, {});
        const auto [p1, l1] = momentum();
        CHECK((p1 - p0).norm() < 1e-6 * p0.norm());
        if (s.bones.size() == 4) CHECK((l1 - l0).norm() < 0.01 * l0.norm());
    }
}

TEST_CASE("bone dynamics: gravity bends what is held by as much as its springs say, and what is free falls as a stone does") {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.bendHertz = 2.0, spring.bendDamping = 1.0, spring.stretchHertz = 100.0;
    auto input = inputOf(s, spring);
    input.settings.gravity = Vec3(0, -9.81, 0);
    auto dynamics = BoneDynamics::build(input).value();
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    for (int i = 0; i < 600; ++i) dynamics.step(kFrame, restPose(s), holds);
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
            input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -2, 0), Vec3(0, 3, 0), friction};
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
        input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -1, 0), Vec3(0.2, 1, 0), 0.3};
        auto dynamics = BoneDynamics::build(input).value();
        for (int i = 0; i < rate; ++i) dynamics.step(1.0 / rate, restPose(s), {});
        seen.push_back(dynamics.pose());
    }
    CHECK(farthestFrom(seen[0], restPose(s)) > 0.5);
    CHECK(farthestFrom(seen[0], seen[1]) < 1e-9);
    CHECK(farthestFrom(seen[0], seen[2]) < 1e-9);
}

TEST_CASE("bone dynamics: bodies of a micrometre and of a thousand kilometres move alike") {
    std::vector<Pose> seen;
    for (const double size : {1.0, 1e-6, 1e6}) {
        const Skeleton s = boneChain(4, size);
        auto input = inputOf(s);
        for (double& m : input.mass) m *= size * size * size;
        input.settings.gravity = Vec3(0, -5.0 * size, 0);
        input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -0.2 * size, 0), Vec3::UnitY(), 0.3};
        auto dynamics = BoneDynamics::build(input).value();
        const std::vector<Hold> holds = {{0, Vec3::Zero()}};
        Pose pose = restPose(s);
        for (int i = 0; i < 100; ++i) {
            if (i < 20)
                for (auto& p : pose.points) p += size * Vec3(0.0, 0.03, 0.02);
            dynamics.step(kFrame, pose, holds);
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

TEST_CASE("bone dynamics: a body on a slope stays where friction is strong and slides where it is weak") {
    const Skeleton s = boneChain(2);
    for (const double friction : {0.2, 0.9}) {
        auto input = inputOf(s);
        input.settings.gravity = Vec3(0, -9.81, 0);
        input.settings.returnHertz = 0.0;
        input.settings.ground = BoneDynamicsSettings::Ground{Vec3::Zero(), Vec3(0, std::cos(0.5), -std::sin(0.5)), friction};  // tan .5 = .55
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
    input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, 0, 0), Vec3::UnitY(), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    for (int i = 0; i < 60; ++i) dynamics.step(kFrame, restPose(s), {});
    REQUIRE(dynamics.resting());
    input.settings.ground->point.y() = 0.1;
    REQUIRE(dynamics.set(input.settings));
    dynamics.step(kFrame, restPose(s), {});
    for (const auto& p : dynamics.pose().points) CHECK(p.y() >= 0.1 - 1e-6);
    input.settings.ground->point.y() = -5.0;
    REQUIRE(dynamics.set(input.settings));
    const double before = dynamics.pose().points[0].y();
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, restPose(s), {});
    for (const auto& p : dynamics.pose().points) CHECK(before - p.y() == doctest::Approx(0.5 * 9.81 * 0.25).epsilon(0.05));
}

TEST_CASE("bone dynamics: held points stay above the ground, too") {
    const Skeleton s = boneChain(3);
    auto input = inputOf(s);
    input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -0.2, 0), Vec3::UnitY(), 0.5};
    auto dynamics = BoneDynamics::build(input).value();
    Pose pose = restPose(s);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}, {3, Vec3::Zero()}};
    for (int i = 0; i < 60; ++i) {
        pose.points[3].y() -= 0.02;
        dynamics.step(kFrame, pose, holds);
        for (const auto& p : dynamics.pose().points) CHECK(p.y() >= -0.2 - 1e-6);
    }
    CHECK(dynamics.pose().points[3].y() == doctest::Approx(-0.2));
}

TEST_CASE("bone dynamics: grabbing a swinging point does not make it jump") {
    const Skeleton s = boneChain(4);
    auto dynamics = make(s);
    Pose pose = restPose(s);
    std::vector<Hold> holds = {{0, s.points[0]}};
    for (int i = 0; i < 20; ++i) {
        for (auto& p : pose.points) p.y() += 0.03;
        dynamics.step(kFrame, pose, holds);
    }
    const Vec3 before = dynamics.pose().points[4];
    const double away = (before - pose.points[4]).norm();
    REQUIRE(away > 0.05);
    holds.push_back({4, Vec3::Zero()});
    dynamics.step(1e-3, pose, holds);
    CHECK((dynamics.pose().points[4] - before).norm() < 0.1 * away);
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, pose, holds);
    CHECK((dynamics.pose().points[4] - pose.points[4]).norm() < 1e-4);
}

TEST_CASE("bone dynamics: a pause of ten seconds is cut short and said") {
    const Skeleton s = boneChain(5);
    auto dynamics = make(s);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, curled(s, 0.0), holds);
    dynamics.step(10.0, curled(s, 0.5), holds);
    CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::TimeDropped));
    checkFinite(dynamics.pose());
    CHECK(farthestFrom(dynamics.pose(), curled(s, 0.5)) < 5.0);
    dynamics.step(1e300, curled(s, 0.5), holds);
    checkFinite(dynamics.pose());
    dynamics.step(0.0, curled(s, 0.5), holds);
    CHECK(dynamics.warnings() == 0u);
}

TEST_CASE("bone dynamics: what is not finite does not go on: the last good state stays, and it is said") {
    const Skeleton s = boneChain(4);
    auto dynamics = make(s);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, curled(s, 0.2), holds);
    const Pose good = dynamics.pose();
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinite, 1e300}) {
        Pose pose = curled(s, 0.3);
        pose.points[2].y() = bad;
        dynamics.step(kFrame, pose, holds);
        CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
        pose = curled(s, 0.3);
        pose.roll[1] = bad;
        dynamics.step(kFrame, pose, holds);
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
    }
    for (const double bad : {nan, infinite, -1.0}) {
        dynamics.step(bad, curled(s, 0.3), holds);
        CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
        CHECK(farthestFrom(dynamics.pose(), good) == 0.0);
    }
    dynamics.step(kFrame, Pose{}, holds);
    CHECK(dynamics.warnings() == static_cast<unsigned>(DynamicsWarning::InputRefused));
    const std::vector<Hold> elsewhere = {{0, Vec3::Zero()}, {99, Vec3::Zero()}, {-1, Vec3::Zero()}};
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
    input.settings.ground = BoneDynamicsSettings::Ground{Vec3::Zero(), Vec3::Zero(), 0.5};
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
    input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -0.8, 0), Vec3::UnitY(), 0.4};
    auto one = BoneDynamics::build(input).value(), other = BoneDynamics::build(input).value();
    Pose pose = restPose(s);
    const std::vector<Hold> all = {{0, Vec3::Zero()}, {4, Vec3::Zero()}};
    std::size_t asked = 0;
    for (int i = 0; i < 120; ++i) {
        const std::span<const Hold> holds = std::span(all).first(i < 40 ? 1 : i < 80 ? 2 : 0);
        for (auto& p : pose.points) p.x() += 0.01 * std::sin(0.2 * i);
        pose.roll[5] = 0.01 * i;
        const std::size_t before = allocations();
        one.step(1.0 / 70.0, pose, holds);
        asked += allocations() - before;
        other.step(1.0 / 70.0, pose, holds);
        REQUIRE(farthestFrom(one.pose(), other.pose()) == 0.0);
    }
    CHECK(asked == 0);
}

TEST_CASE("bone dynamics: roll follows what is held with its own frequency and damping") {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.rollHertz = 1.5;
    spring.rollDamping = 0.1;
    auto dynamics = make(s, spring);
    const std::vector<Hold> holds = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, restPose(s), holds);
    Pose twisted = restPose(s);
    twisted.roll[1] = 1.0;
    dynamics.reset(twisted);
    std::vector<double> signal;
    for (int i = 0; i < 400; ++i) {
        dynamics.step(0.01, restPose(s), holds);
        signal.push_back(dynamics.pose().roll[1]);
    }
    const auto seen = measure(signal, 0.01);
    CHECK(seen.hertz == doctest::Approx(1.5).epsilon(0.02));
    CHECK(seen.damping == doctest::Approx(0.1).epsilon(0.02));
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
        if (scene % 4 == 1) input.settings.ground = BoneDynamicsSettings::Ground{Vec3(0, -1, 0), Vec3::UnitY(), 0.4};
        auto dynamics = BoneDynamics::build(input).value();
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        std::vector<Hold> holds = {{0, s.points[0]}};
        for (int i = 0; i < 400; ++i) {
            if (i % 40 == 0) {
                holds.resize(1);
                for (int k = static_cast<int>(random() % 3); k > 0; --k) {
                    const int point = 1 + static_cast<int>(random() % (s.points.size() - 1));
                    holds.push_back({point, pose.points[point]});
                }
            }
            for (std::size_t k = 1; k < holds.size(); ++k) holds[k].target += 0.2 * Vec3(d(random), d(random), d(random));
            ik.solve(holds, pose);
            dynamics.step(1.0 / pick(rates), pose, holds);
            checkFinite(dynamics.pose());
            for (const auto& p : dynamics.pose().points) REQUIRE(p.norm() < 200.0);
            if (input.settings.ground)
                for (const auto& p : dynamics.pose().points) REQUIRE(p.y() >= -1.0 - 1e-6);
        }
        // Parameters of flesh: it comes to rest.
        input.settings.springs = {BoneSpring{}};
        REQUIRE(dynamics.set(input.settings));
        ++scenes;
        for (int i = 0; i < 1800 && !dynamics.resting(); ++i) dynamics.step(kFrame, pose, holds);
        rested += dynamics.resting();
        if (dynamics.resting() && input.settings.gravity.isZero() && !input.settings.ground) CHECK(farthestFrom(dynamics.pose(), pose) == 0.0);
    }
    CHECK(rested == scenes);
}
