// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/dynamics/bone_dynamics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "core/skeleton/bone_tree.h"
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
                spring.swingHertz = hertz;
                spring.swingDamping = damping;
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
