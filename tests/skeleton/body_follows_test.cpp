// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/skeleton/body_follows.h"
#include "core/skeleton/inverse_kinematics.h"

using namespace imomushi;

namespace {

/// A figure that stands on two legs: spine, and arms and legs of two bones. Legs are bent a little, as one stands.
Skeleton standing() {
    Skeleton s;
    s.points = {{0, 1, 0}, {0, 1.5, 0}, {0, 1.8, 0}, {.3, 1.45, 0}, {.6, 1.4, 0}, {-.3, 1.45, 0}, {-.6, 1.4, 0}, {.15, .5, .05}, {.15, 0, 0}, {-.15, .5, .05}, {-.15, 0, 0}};
    const auto add = [&](int start, int end, int parent) {
        Skeleton::Bone bone;
        bone.start = start, bone.end = end, bone.parent = parent;
        bone.length = (s.points[static_cast<std::size_t>(end)] - s.points[static_cast<std::size_t>(start)]).norm();
        s.bones.push_back(bone);
    };
    add(0, 1, -1), add(1, 2, 0), add(1, 3, 0), add(3, 4, 2), add(1, 5, 0), add(5, 6, 4), add(0, 7, 0), add(7, 8, 6), add(0, 9, 0), add(9, 10, 8);
    return s;
}

double turnOf(const Skeleton& s, const Pose& pose, std::size_t bone) {
    const auto& b = s.bones[bone];
    const auto along = [&](const std::vector<Vec3>& p) { return Vec3(p[static_cast<std::size_t>(b.end)] - p[static_cast<std::size_t>(b.start)]); };
    const Vec3 a = along(s.points), now = along(pose.points);
    return std::atan2(a.cross(now).norm(), a.dot(now)) * 180.0 / M_PI;
}

int settle(InverseKinematics& ik, const std::vector<IkGoal>& goals, Pose& pose) {
    constexpr int kMost = 1000;
    for (int i = 1; i <= kMost; ++i)
        if (ik.solve(goals, pose).converged) return i;
    return kMost + 1;
}

const std::vector<IkGoal> kFeet = {{8, {.15, 0, 0}, false, 0.0, true}, {10, {-.15, 0, 0}, false, 0.0, true}};

}  // namespace

TEST_CASE("body follows: the arm moves, the trunk hardly leans, and without it the trunk leans") {
    for (const Vec3 by : {Vec3(0, .3, 0), Vec3(0, 0, .4), Vec3(-.3, .1, 0), Vec3(.2, -.3, .2)}) {
        double lean[2] = {};
        for (const bool on : {false, true}) {
            Skeleton s = standing();
            letBodyFollow(s, on ? 1.0 : 0.0);
            InverseKinematics ik(s);
            Pose pose = restPose(s);
            std::vector<IkGoal> goals = kFeet;
            goals.push_back({4, s.points[4] + by});
            CHECK(settle(ik, goals, pose) < 1000);
            CHECK((pose.points[4] - s.points[4] - by).norm() < 1e-4);
            lean[on ? 1 : 0] = turnOf(s, pose, 0);
            if (on) CHECK(std::max(turnOf(s, pose, 2), turnOf(s, pose, 3)) > lean[1]);
        }
        MESSAGE("the trunk leans by " << lean[0] << " degrees, with it by " << lean[1]);
        CHECK(lean[1] < 8.0);
        CHECK(lean[1] < 0.6 * lean[0] + 1e-3);
    }
}

TEST_CASE("body follows: the pose at rest keeps no path, and is that of rest when all is let go") {
    Skeleton s = standing();
    letBodyFollow(s, 1.0);
    const auto goalsAt = [&](const Vec3& to) {
        std::vector<IkGoal> goals = kFeet;
        goals.push_back({4, to});
        return goals;
    };
    const Vec3 to(.5, 1.7, .3);
    Pose straight = restPose(s), around = straight;
    InverseKinematics one(s), two(s);
    settle(one, goalsAt(to), straight);
    for (const Vec3& by : {Vec3(.7, 1.2, -.2), Vec3(.3, 1.9, .2), Vec3(.6, 1.3, .5), to}) settle(two, goalsAt(by), around);
    for (std::size_t i = 0; i < s.points.size(); ++i) CHECK((straight.points[i] - around.points[i]).norm() < 2e-3);
    settle(two, goalsAt(s.points[4]), around);
    for (std::size_t i = 0; i < s.points.size(); ++i) CHECK((around.points[i] - s.points[i]).norm() < 2e-3);
}

TEST_CASE("body follows: who is turned by the feet turns as a whole") {
    Skeleton s = standing();
    letBodyFollow(s, 1.0);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    for (int degrees = 0; degrees <= 120; degrees += 10) {
        const Eigen::AngleAxisd turn(degrees * M_PI / 180.0, Vec3::UnitY());
        std::vector<IkGoal> goals = kFeet;
        for (IkGoal& goal : goals) goal.target = turn * goal.target + Vec3(0, 0, .01 * degrees);
        settle(ik, goals, pose);
        CHECK(turnOf(s, pose, 0) < 1.0);
        // The knees are where those of a turned figure are.
        const Vec3 knee = turn * s.points[7] + Vec3(0, 0, .01 * degrees);
        CHECK((pose.points[7] - knee).norm() < 0.03);
    }
}

TEST_CASE("body follows: bones that meet in the middle of a trunk without a bone of its own keep it upright") {
    // Four legs, a head with a horn on either side, and a tail, each on a bone from the middle.
    Skeleton s;
    std::vector<int> elementOf;
    s.points = {{0, .45, 0}};
    const auto add = [&](int start, const Vec3& end, int parent, int element) {
        Skeleton::Bone bone;
        bone.start = start, bone.end = static_cast<int>(s.points.size()), bone.parent = parent;
        bone.length = (end - s.points[static_cast<std::size_t>(start)]).norm();
        s.points.push_back(end);
        s.bones.push_back(bone);
        elementOf.push_back(element);
        return static_cast<int>(s.bones.size()) - 1;
    };
    std::vector<IkGoal> feet;
    int element = 1;
    for (const Vec3& foot : {Vec3(.3, 0, .4), Vec3(-.3, 0, .4), Vec3(.3, 0, -.4), Vec3(-.3, 0, -.4)}) {
        const int base = add(0, Vec3(.8 * foot.x(), .25, .9 * foot.z()), s.bones.empty() ? -1 : 0, 0);
        const int leg = add(s.bones[static_cast<std::size_t>(base)].end, foot, base, element++);
        feet.push_back({s.bones[static_cast<std::size_t>(leg)].end, foot, false, 0.0, true});
    }
    const int neck = add(0, Vec3(0, .9, .5), 0, 0), head = add(s.bones[static_cast<std::size_t>(neck)].end, Vec3(0, 1.2, .7), neck, element++);
    const int top = s.bones[static_cast<std::size_t>(head)].end;
    for (const double side : {.3, -.3}) add(top, Vec3(side, 1.4, .7), head, element++);
    const int tail = add(0, Vec3(0, .6, -.6), 0, 0);
    add(s.bones[static_cast<std::size_t>(tail)].end, Vec3(0, .5, -.8), tail, element++);
    double lean[2] = {};
    for (const bool known : {false, true}) {
        letBodyFollow(s, 1.0, known ? std::span<const int>(elementOf) : std::span<const int>());
        InverseKinematics ik(s);
        for (const Vec3& by : {Vec3(.28, 0, 0), Vec3(0, .28, 0), Vec3(0, 0, -.28)}) {
            Pose pose = restPose(s);
            std::vector<IkGoal> goals = feet;
            goals.push_back({top, s.points[static_cast<std::size_t>(top)] + by});
            CHECK(settle(ik, goals, pose) < 1000);
            for (const int b : {0, 2, 4, 6, neck, tail}) lean[known ? 1 : 0] = std::max(lean[known ? 1 : 0], turnOf(s, pose, static_cast<std::size_t>(b)));
            if (known) CHECK(turnOf(s, pose, static_cast<std::size_t>(head)) > turnOf(s, pose, static_cast<std::size_t>(neck)));
        }
    }
    MESSAGE("the trunk turns by " << lean[0] << " degrees where its element is not known, else by " << lean[1]);
    CHECK(lean[1] < 15.0);
    CHECK(lean[1] < 0.8 * lean[0]);
    // An end that nothing hangs on is a limb, not the frame.
    letBodyFollow(s, 1.0, elementOf);
    const double ear = s.bones[static_cast<std::size_t>(head) + 1].upright;
    CHECK(ear < 0.2 * s.bones[static_cast<std::size_t>(neck)].upright);
}
