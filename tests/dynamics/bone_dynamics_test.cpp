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

namespace {

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

/// How a bone that keeps its length swings free from an angle to its kinematic direction, held at its start.
Swinging swingFrom(double angle, double hertz, double damping, double airDamping) {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.bendHertz = hertz;
    spring.bendDamping = damping;
    spring.stretchHertz = 1000.0;
    spring.stretchDamping = 1.0;
    auto input = inputOf(s, spring);
    input.settings.airDamping = airDamping;
    auto dynamics = BoneDynamics::build(input).value();
    Pose bent = restPose(s);
    bent.points[1] = Vec3(std::cos(angle), std::sin(angle), 0);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, restPose(s), goals);
    dynamics.reset(bent);
    std::vector<double> signal;
    const double dt = 0.02 / hertz;
    // From `bent` the kinematic pose jumps to rest within the first frame.
    for (int i = 0; i < 250; ++i) {
        dynamics.step(i == 0 ? 1e-4 : dt, restPose(s), goals);
        signal.push_back(std::atan2(dynamics.pose().points[1].y(), dynamics.pose().points[1].x()));
    }
    return measure(signal, dt);
}

}  // namespace

TEST_CASE("bone dynamics: a swinging bone has the frequency and damping that were asked for, at small and large angles") {
    for (const double hertz : {0.3, 2.0, 8.0})
        for (const double damping : {0.02, 0.1, 0.3})
            for (const double angle : {0.05, 1.5}) {
                CAPTURE(hertz);
                CAPTURE(damping);
                CAPTURE(angle);
                const auto seen = swingFrom(angle, hertz, damping, 0.0);
                CHECK(seen.hertz == doctest::Approx(hertz).epsilon(0.02));
                CHECK(seen.damping == doctest::Approx(damping).epsilon(0.02));
            }
}

TEST_CASE("bone dynamics: air damps a slow sway more than a fast swing, by rate / (2 omega), and nothing that is not held") {
    for (const double hertz : {0.3, 3.0}) {
        CAPTURE(hertz);
        CHECK(swingFrom(0.3, hertz, 0.0, 0.5).damping == doctest::Approx(0.5 / (2.0 * 2.0 * M_PI * hertz)).epsilon(0.05));
    }
    const Skeleton s = boneChain(1);
    auto input = inputOf(s);
    input.settings.gravity = Vec3(0, -9.81, 0);
    input.settings.returnHertz = 0.0;
    input.settings.airDamping = 50.0;
    auto falling = BoneDynamics::build(input).value();
    for (int i = 0; i < 60; ++i) falling.step(1.0 / 60.0, restPose(s), {});
    CHECK(falling.velocities()[0].y() == doctest::Approx(-9.81).epsilon(1e-6));
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
        const std::vector<IkGoal> goals = {{at, Vec3::Zero()}};
        dynamics.step(kFrame, restPose(s), goals);
        Pose turned = restPose(s);
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3(0, 1, 1).normalized()));
        for (int i = tip; i != pivot; i += fromEnd ? 1 : -1) turned.points[i] = s.points[pivot] + turn * (s.points[i] - s.points[pivot]);
        dynamics.reset(turned);
        std::vector<double> signal;
        for (int i = 0; i < 600; ++i) {
            dynamics.step(i == 0 ? 1e-4 : 0.01, restPose(s), goals);
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
                const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
                dynamics.step(kFrame, restPose(s), goals);
                dynamics.reset(longer);
                std::vector<double> signal;
                const double dt = 0.02 / hertz;
                for (int i = 0; i < 250; ++i) {
                    dynamics.step(i == 0 ? 1e-4 : dt, restPose(s), goals);
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
    const std::vector<IkGoal> goals = {{0, s.points[0]}};
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, restPose(s), goals);
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
        std::vector<IkGoal> goals = {{0, s.points[0]}, {last, s.points[last]}};
        double overshoot = 0.0;
        int frames = 0;
        for (; frames < 3000 && !dynamics.resting(); ++frames) {
            goals[1].target = s.points[last] + std::min(frames / 10.0, 1.0) * Vec3(-0.3, 0.5, 0.4);
            ik.solve(goals, pose);
            dynamics.step(kFrame, pose, goals);
            overshoot = std::max(overshoot, farthestFrom(dynamics.pose(), pose));
        }
        CHECK(overshoot > 0.02);
        CHECK(frames < 1200);
        REQUIRE(dynamics.resting());
        CHECK(farthestFrom(dynamics.pose(), pose) == 0.0);
    }
}

TEST_CASE("bone dynamics: a chain dragged along a path moves alike at 30, 60, 144 and uneven frames per second") {
    const Skeleton s = boneChain(5);
    BoneSpring spring;
    spring.bendHertz = 1.5;
    spring.bendDamping = 0.15;
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
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
                dynamics.step(uneven / 6.0, curled(s, (sixth + time) / 6.0), goals);
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
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    Pose pose = restPose(s);
    dynamics.step(kFrame, pose, goals);
    const double speed = 0.2;
    for (int i = 0; i < 15; ++i) {
        for (auto& p : pose.points) p.y() += speed * kFrame;
        dynamics.step(kFrame, pose, goals);
    }
    // y'' = -2 ratio omega y' from y' = -speed, the spring being weak: 1 % of the return in this quarter of a second.
    const double lag = pose.points[1].y() - dynamics.pose().points[1].y();
    CHECK(lag == doctest::Approx(speed / (2.0 * 10.0 * 2.0 * M_PI * 0.5)).epsilon(0.05));
}

TEST_CASE("bone dynamics: bones that are stiff to the eye follow the kinematic pose") {
    const Skeleton s = boneChain(5);
    BoneSpring rigid;
    rigid.stretchHertz = rigid.bendHertz = rigid.rollHertz = BoneSpring::kMaxHertz;
    rigid.stretchDamping = rigid.bendDamping = rigid.rollDamping = 1.0;
    auto dynamics = make(s, rigid);
    dynamics.reset(curled(s, 0.0));
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    double away = 0.0, roll = 0.0, turn = 0.0;
    for (int i = 1; i <= 240; ++i) {
        const Pose kinematic = curled(s, i * kFrame);
        dynamics.step(kFrame, kinematic, goals);
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
        if (scene % 4 == 3) input.settings.ground = BoneDynamicsSettings::Ground{Plane::through(Vec3(0, -1.5, 0), Vec3(0.1, 1, 0)).value(), 0.5};
        if (scene % 5 == 4) input.settings.returnHertz = 0.0;
        if (scene % 7 == 6) input.settings.airDamping = any(0.1, 100.0);
        auto dynamics = BoneDynamics::build(input).value();
        Pose wild = restPose(s);
        for (auto& p : wild.points) p += Vec3(d(random), d(random), d(random));
        std::vector<IkGoal> goals;
        if (scene % 5 != 4) goals.push_back({0, Vec3::Zero()});
        dynamics.step(kFrame, restPose(s), goals);
        dynamics.reset(wild);
        // The kinematic pose jumps to rest, and the held point comes home.
        for (int i = 0; i < 200; ++i) dynamics.step(0.01, restPose(s), goals);
        double before = dynamics.energy().total();
        const double first = before;
        double weight = 0.0;
        for (const double m : input.mass) weight += m * input.settings.gravity.norm();
        for (int i = 0; i < 300; ++i) {
            dynamics.step(1.0 / 97.0, restPose(s), goals);
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
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    Pose bent = restPose(s);
    bent.points[3] += Vec3(-0.2, 0.6, 0.3);
    dynamics.step(kFrame, restPose(s), goals);
    dynamics.reset(bent);
    for (int i = 0; i < 2; ++i) dynamics.step(0.01, restPose(s), goals);  // the kinematic pose jumps to rest
    const double first = dynamics.energy().total();
    REQUIRE(first > 0.0);
    for (int i = 0; i < 300; ++i) dynamics.step(kFrame, restPose(s), goals);
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
        const std::vector<IkGoal> goals = {{0, s.points[0]}};
        for (int i = 0; i < 12; ++i) {
            for (auto& p : pose.points) p += Vec3(0.03, 0.05, 0.02);
            dynamics.step(kFrame, pose, goals);
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

TEST_CASE("bone dynamics: grabbing a swinging point does not make it jump") {
    const Skeleton s = boneChain(4);
    auto dynamics = make(s);
    Pose pose = restPose(s);
    std::vector<IkGoal> goals = {{0, s.points[0]}};
    for (int i = 0; i < 20; ++i) {
        for (auto& p : pose.points) p.y() += 0.03;
        dynamics.step(kFrame, pose, goals);
    }
    const Vec3 before = dynamics.pose().points[4];
    const double away = (before - pose.points[4]).norm();
    REQUIRE(away > 0.05);
    goals.push_back({4, Vec3::Zero()});
    dynamics.step(1e-3, pose, goals);
    CHECK((dynamics.pose().points[4] - before).norm() < 0.1 * away);
    for (int i = 0; i < 30; ++i) dynamics.step(kFrame, pose, goals);
    CHECK((dynamics.pose().points[4] - pose.points[4]).norm() < 1e-4);
}

TEST_CASE("bone dynamics: a point that is grabbed where it is stays there, however far away its kinematic place was before") {
    const Skeleton s = boneChain(4);
    auto dynamics = make(s, BoneSpring());
    // Far from rest, as after a throw: the kinematic pose has been back at rest for a frame.
    Pose away = restPose(s);
    for (std::size_t i = 1; i < away.points.size(); ++i) away.points[i] = Vec3(0, static_cast<double>(i), 0);
    dynamics.step(kFrame, away, std::vector<IkGoal>{{0, Vec3::Zero()}});
    dynamics.reset(away);
    dynamics.step(1e-4, restPose(s), std::vector<IkGoal>{{0, Vec3::Zero()}});
    const std::size_t tip = s.points.size() - 1;
    const Vec3 before = dynamics.pose().points[tip];
    REQUIRE((before - s.points[tip]).norm() > 4.0);
    Pose held = restPose(s);
    held.points[tip] = before;
    for (int i = 0; i < 5; ++i) {
        dynamics.step(kFrame, held, std::vector<IkGoal>{{0, Vec3::Zero()}, {static_cast<int>(tip), before}});
        CHECK((dynamics.pose().points[tip] - before).norm() < 1e-6);
    }
}

TEST_CASE("bone dynamics: roll follows what is held with its own frequency and damping") {
    const Skeleton s = boneChain(1);
    BoneSpring spring;
    spring.rollHertz = 1.5;
    spring.rollDamping = 0.1;
    auto dynamics = make(s, spring);
    const std::vector<IkGoal> goals = {{0, Vec3::Zero()}};
    dynamics.step(kFrame, restPose(s), goals);
    Pose twisted = restPose(s);
    twisted.roll[1] = 1.0;
    dynamics.reset(twisted);
    std::vector<double> signal;
    for (int i = 0; i < 400; ++i) {
        dynamics.step(0.01, restPose(s), goals);
        signal.push_back(dynamics.pose().roll[1]);
    }
    const auto seen = measure(signal, 0.01);
    CHECK(seen.hertz == doctest::Approx(1.5).epsilon(0.02));
    CHECK(seen.damping == doctest::Approx(0.1).epsilon(0.02));
}
