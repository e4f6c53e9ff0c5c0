// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/base/block_cholesky.h"
#include "core/skeleton/inverse_kinematics.h"
#include "core/skeleton/rod_energy.h"

using namespace imomushi;

namespace {

/// A trunk that is held at both ends, and a straight leg of two bones that hangs beside it; its knee goes to +Z.
Skeleton leg(double slant = 0.0) {
    Skeleton s;
    s.points = {{0, 1, 0}, {0, 1.5, 0}, {.1, .5, slant}, {.1, 0, 0}, {.1, 1, 0}};
    const auto add = [&](int start, int end, int parent) {
        Skeleton::Bone bone;
        bone.start = start, bone.end = end, bone.parent = parent;
        bone.length = (s.points[static_cast<std::size_t>(end)] - s.points[static_cast<std::size_t>(start)]).norm();
        s.bones.push_back(bone);
    };
    add(0, 1, -1), add(0, 4, 0), add(4, 2, 1), add(2, 3, 2);
    s.bones[3].hinge = Vec3::UnitX();
    return s;
}

std::vector<IkGoal> pushed(const Skeleton& s, const Vec3& foot) { return {{0, s.points[0]}, {1, s.points[1]}, {3, foot}}; }

InverseKinematics::Report solved(InverseKinematics& ik, const std::vector<IkGoal>& goals, Pose& pose) {
    InverseKinematics::Report report;
    for (int i = 0; i < 1000; ++i) {
        report = ik.solve(goals, pose);
        if (report.converged) break;
    }
    return report;
}

double lengthNow(const Skeleton& s, const Pose& pose, std::size_t bone) {
    return (pose.points[static_cast<std::size_t>(s.bones[bone].end)] - pose.points[static_cast<std::size_t>(s.bones[bone].start)]).norm() / s.bones[bone].length;
}

}  // namespace

TEST_CASE("hinge: a straight leg that is pushed along itself folds forward at its knee, hardly shorter, also where the push is a little to another side") {
    for (const double up : {.05, .2, .35})
        for (const Vec3 aside : {Vec3(0, 0, 0), Vec3(0, 0, .02), Vec3(0, 0, -.02), Vec3(.02, 0, 0), Vec3(-.02, 0, 0)})
            for (const double slant : {0.0, .01, -.01}) {
                CAPTURE(up);
                CAPTURE(aside.transpose());
                CAPTURE(slant);
                const Skeleton s = leg(slant);
                InverseKinematics ik(s);
                Pose pose = restPose(s);
                const Vec3 to = s.points[3] + Vec3(0, up, 0) + aside;
                CHECK(solved(ik, pushed(s, to), pose).converged);
                CHECK((pose.points[3] - to).norm() < 1e-4);
                const Vec3 knee = pose.points[2] - 0.5 * (pose.points[4] + pose.points[3]);
                CHECK(knee.z() > 0.5 * std::sqrt(0.25 - 0.25 * (1.0 - up) * (1.0 - up)));  // of where bones of their own length have it
                CHECK(std::abs(knee.x()) < 0.25 * knee.z());
                for (const std::size_t bone : {2u, 3u}) CHECK(lengthNow(s, pose, bone) > 0.95);
                CHECK(solved(ik, pushed(s, s.points[3]), pose).converged);  // back, it is straight again
                for (std::size_t p = 0; p < s.points.size(); ++p) CHECK((pose.points[p] - s.points[p]).norm() < 0.01);
            }
}

TEST_CASE("hinge: the pose keeps no path: a leg that is pushed at once, step by step, or farther and back is folded alike") {
    const Skeleton s = leg();
    const auto to = [&](double up) { return pushed(s, s.points[3] + Vec3(0, up, 0)); };
    InverseKinematics once(s), steps(s), beyond(s);
    Pose a = restPose(s), b = a, c = a;
    CHECK(solved(once, to(.3), a).converged);
    for (int i = 1; i < 60; ++i) steps.solve(to(.3 * i / 60.0), b);
    CHECK(solved(steps, to(.3), b).converged);
    CHECK(solved(beyond, to(.5), c).converged);
    CHECK(solved(beyond, to(.3), c).converged);
    for (std::size_t p = 0; p < s.points.size(); ++p) {
        CHECK((a.points[p] - b.points[p]).norm() < 5e-3);
        CHECK((a.points[p] - c.points[p]).norm() < 5e-3);
    }
}

TEST_CASE("hinge: the force is minus the slope of the energy") {
    const Skeleton s = leg();
    RodEnergy rods(s);
    IkTargets targets;
    targets.held.assign(s.points.size(), 0);
    targets.place.assign(s.points.size(), Vec3::Zero());
    BlockCholesky<3> system(std::vector<int>(s.points.size(), 3), rods.pairs());
    std::mt19937 random(7);
    std::uniform_real_distribution<double> d(-.15, .15);
    for (int run = 0; run < 20; ++run) {
        Pose pose = restPose(s);
        std::vector<Vec3> x = pose.points;
        for (auto& p : x)
            for (int k = 0; k < 3; ++k) p[k] += d(random);
        std::vector<Eigen::Quaterniond> frames(s.bones.size());
        rods.transport(x, pose.frames, frames);
        std::vector<Vec3> force(s.points.size());
        rods.linearise(x, frames, targets, 0.1, system, force);
        for (const std::size_t p : {2u, 3u})  // the frames above them do not turn
            for (int k = 0; k < 3; ++k) {
                constexpr double h = 1e-6;
                std::vector<Vec3> more = x, less = x;
                more[p][k] += h, less[p][k] -= h;
                CHECK(force[p][k] == doctest::Approx(-(rods.energy(more, targets) - rods.energy(less, targets)) / (2.0 * h)).epsilon(1e-4).scale(0.01));
            }
    }
}
