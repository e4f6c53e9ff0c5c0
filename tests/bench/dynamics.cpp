// SPDX-License-Identifier: GPL-3.0-or-later
// Bone dynamics: cost of a frame beside inverse kinematics of the same skeleton, joint dynamics beside it, and a million frames of random bodies, drags, frame rates and parameters
// at their limits, which must stay finite, bounded and above the ground, and come back to rest. `bench_dynamics 20000` takes fewer frames.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

#include "core/dynamics/bone_dynamics.h"
#include "core/dynamics/joint_dynamics.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/inverse_kinematics.h"
#include "tests/dynamics/skeletons.h"

using namespace imomushi;

namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point from) { return std::chrono::duration<double, std::micro>(Clock::now() - from).count(); }

BoneDynamics::Input inputOf(const Skeleton& s) {
    BoneDynamics::Input input;
    input.skeleton = s;
    input.mass.assign(s.points.size(), 1.0);
    return input;
}

void frames(const char* name, const Skeleton& s, bool ground) {
    auto input = inputOf(s);
    if (ground) {
        input.settings.gravity = Vec3(0, -9.81, 0);
        input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-0.3), 0.5};
    }
    auto dynamics = BoneDynamics::build(input).value();
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    const int last = static_cast<int>(s.points.size()) - 1;
    std::vector<IkGoal> goals = {{0, s.points[0]}, {last, s.points[last]}};
    constexpr int kFrames = 3000;
    std::vector<double> solve, step;
    for (int i = 0; i < kFrames; ++i) {
        const double t = i / 60.0;
        goals[1].target = s.points[last] + Vec3(-0.5 + 0.5 * std::cos(2.0 * t), 0.6 * std::sin(3.0 * t), 0.4 * std::sin(1.7 * t));
        auto start = Clock::now();
        ik.solve(goals, pose);
        solve.push_back(microseconds(start));
        start = Clock::now();
        dynamics.step(1.0 / 60.0, pose, goals);
        step.push_back(microseconds(start));
    }
    double rest = 0.0;
    for (int i = 0; i < kFrames; ++i) {
        const auto start = Clock::now();
        dynamics.step(1.0 / 60.0, pose, goals);
        if (i >= kFrames / 2) rest += microseconds(start) / (kFrames / 2);
    }
    std::sort(solve.begin(), solve.end()), std::sort(step.begin(), step.end());
    std::printf("%-34s %6zu %10.1f %10.1f %10.1f %10.2f%s\n", name, s.bones.size(), solve[kFrames / 2], step[kFrames / 2], step[kFrames * 99 / 100], rest,
                dynamics.resting() ? "" : " (still moves)");
}

void jointFrames(int parameters) {
    std::mt19937 random(1);
    std::normal_distribution<double> d;
    JointDynamics::Input input;
    const Eigen::MatrixXd m = Eigen::MatrixXd::NullaryExpr(parameters, 2 * parameters, [&] { return d(random); });
    const Eigen::MatrixXd k = Eigen::MatrixXd::NullaryExpr(parameters, parameters, [&] { return d(random); });
    input.mass = m * m.transpose();
    input.stiffness = k * k.transpose();
    auto start = Clock::now();
    auto dynamics = JointDynamics::build(input).value();
    const double build = microseconds(start);
    Eigen::VectorXd target = Eigen::VectorXd::Zero(parameters);
    constexpr int kFrames = 2000;
    start = Clock::now();
    for (int i = 0; i < kFrames; ++i) {
        target.setConstant(std::sin(0.1 * i));
        dynamics.step(1.0 / 60.0, target);
    }
    std::printf("joint dynamics of %3d parameters: built in %.2f ms, %.1f us per frame\n", parameters, 1e-3 * build, microseconds(start) / kFrames);
}

bool million(long count) {
    std::mt19937 random(2026);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    const double hertz[] = {0.01, 0.5, 2.0, 10.0, 1000.0}, ratios[] = {0.0, 0.05, 0.5, 1.0, 10.0}, rates[] = {0.5, 24, 30, 60, 90, 144, 1000};
    const auto pick = [&](const auto& from) { return from[random() % std::size(from)]; };
    long done = 0;
    int scenes = 0, rested = 0, refused = 0;
    double farthest = 0.0, lowest = 0.0, slowest = 0.0;
    const auto start = Clock::now();
    while (done < count) {
        ++scenes;
        const Skeleton s = scenes % 3 == 0 ? boneChain(5) : scenes % 3 == 1 ? boneOctopus(4, 3) : randomTree(random, 3 + static_cast<int>(random() % 9));
        auto input = inputOf(s);
        input.settings.springs.clear();
        for (std::size_t b = 0; b < s.bones.size(); ++b)
            input.settings.springs.push_back({pick(hertz), pick(ratios), pick(hertz), pick(ratios), pick(hertz), pick(ratios)});
        for (double& m : input.mass) m = std::pow(10.0, 3.0 * d(random));
        input.settings.gravity = 10.0 * static_cast<double>(scenes % 3) * Vec3(d(random), d(random), d(random));
        const bool ground = random() % 2;
        if (ground) input.settings.ground = BoneDynamicsSettings::Ground{Plane::level(-1.0), std::abs(d(random))};
        auto dynamics = BoneDynamics::build(input).value();
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        std::vector<IkGoal> goals = {{0, s.points[0]}};
        for (int i = 0; i < 2000; ++i, ++done) {
            if (i % 40 == 0) {
                goals.resize(random() % 2);
                for (int k = static_cast<int>(random() % 3); k > 0; --k) {
                    const int point = static_cast<int>(random() % s.points.size());
                    goals.push_back({point, pose.points[point]});
                }
            }
            const double seconds = 1.0 / pick(rates);
            for (auto& goal : goals) goal.target += std::min(12.0 * seconds, 0.5) * Vec3(d(random), d(random), d(random));
            ik.solve(goals, pose);
            const std::clock_t from = std::clock();
            dynamics.step(seconds, pose, goals);
            slowest = std::max(slowest, 1e6 * static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC);
            if (dynamics.warnings() & static_cast<unsigned>(DynamicsWarning::StepRefused)) ++refused;
            for (const auto& p : dynamics.pose().points) {
                if (!allFinite(p)) return false;
                if (!goals.empty()) farthest = std::max(farthest, (p - pose.points[0]).norm());
                if (ground) lowest = std::min(lowest, p.y() + 1.0);
            }
        }
        input.settings.springs = {BoneSpring{}};
        if (!dynamics.set(input.settings)) return false;
        goals = {{0, pose.points[0]}};
        for (int i = 0; i < 7200 && !dynamics.resting(); ++i) dynamics.step(1.0 / 60.0, pose, goals);
        rested += dynamics.resting();
    }
    std::printf("\n%ld random frames of %d bodies, %.0f s: all finite; %d came to rest within 2 min; %d steps refused\n", done, scenes,
                microseconds(start) * 1e-6, rested, refused);
    std::printf("farthest joint point from another %.3g m (bodies of about 2 m); lowest above the ground %.3g m; slowest frame (of up to 0.25 s) %.0f us\n", farthest, lowest,
                slowest);
    return rested == scenes && lowest >= -1e-6;
}

}  // namespace

int main(int argc, char** argv) {
    std::printf("%-34s %6s %10s %10s %10s %10s\n", "us per frame at 60 Hz, one thread", "bones", "IK", "dynamics", "p99", "at rest");
    frames("caterpillar", boneChain(5), false);
    frames("chain", boneChain(20), false);
    frames("chain", boneChain(100), false);
    frames("octopus", boneOctopus(8, 6), false);
    frames("caterpillar on the ground", boneChain(5), true);
    frames("octopus on the ground", boneOctopus(8, 6), true);
    for (const int parameters : {12, 60, 240}) jointFrames(parameters);
    return million(argc > 1 ? std::atol(argv[1]) : 1000000) ? 0 : 1;
}
