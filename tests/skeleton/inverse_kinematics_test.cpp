// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "core/skeleton/axial_squash.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/inverse_kinematics.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

// Bones of length 1 along x.
Skeleton chain(int bones) {
    Skeleton s;
    for (int i = 0; i <= bones; ++i) s.points.emplace_back(i, 0, 0);
    for (int i = 0; i < bones; ++i) s.bones.push_back({i, i + 1, i - 1, 1.0});
    return s;
}

// A body bone and `arms` arms of `bones` bones from its end.
Skeleton octopus(int arms, int bones) {
    Skeleton s;
    s.points = {Vec3(0, 1, 0), Vec3(0, 0, 0)};
    s.bones.push_back({0, 1, -1, 1.0});
    for (int a = 0; a < arms; ++a) {
        int at = 1, parent = 0;
        const double angle = 2 * M_PI * a / arms;
        const Vec3 out(std::cos(angle), -0.3, std::sin(angle));
        for (int i = 1; i <= bones; ++i) {
            s.points.push_back(0.6 * i * out);
            const int point = static_cast<int>(s.points.size()) - 1;
            s.bones.push_back({at, point, parent, (s.points[point] - s.points[at]).norm()});
            at = point;
            parent = static_cast<int>(s.bones.size()) - 1;
        }
    }
    return s;
}

int settle(InverseKinematics& ik, const std::vector<IkGoal>& goals, Pose& pose, InverseKinematics::Report& report, int most = 200) {
    for (int i = 1; i <= most; ++i) {
        report = ik.solve(goals, pose);
        if (report.converged) return i;
    }
    return most + 1;
}

// Within four seconds; where frames are so long that these are few, as many as that has at 60 Hz.
bool settleIn(InverseKinematics& ik, const std::vector<IkGoal>& goals, Pose& pose, InverseKinematics::Report& report, double seconds) {
    const int most = static_cast<int>(std::min(4.0 / seconds, 16000.0)) + 240;
    for (int i = 0; i < most; ++i) {
        report = ik.solve(goals, pose, seconds);
        if (report.converged) return true;
    }
    return false;
}

double largestMove(const Pose& a, const Pose& b) {
    double m = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i) m = std::max(m, (a.points[i] - b.points[i]).norm());
    return m;
}

double largestTurn(const Pose& a, const Pose& b) {
    double m = 0;
    for (std::size_t i = 0; i < a.frames.size(); ++i) m = std::max(m, a.frames[i].angularDistance(b.frames[i]));
    return m;
}

bool finite(const Pose& pose) {
    bool ok = true;
    for (const auto& p : pose.points) ok = ok && p.allFinite();
    for (const auto& q : pose.frames) ok = ok && q.coeffs().allFinite();
    for (const double r : pose.roll) ok = ok && std::isfinite(r);
    return ok;
}

void checkFramesFollowBones(const Skeleton& s, const Pose& pose) {
    const BoneTree tree = boneTree(s);
    for (std::size_t b = 0; b < s.bones.size(); ++b) {
        const Vec3 along = pose.points[s.bones[b].end] - pose.points[s.bones[b].start];
        if (along.norm() > 1e-6) CHECK((pose.frames[b] * tree.restDirection[b] - along.normalized()).norm() < 1e-9);
        if (tree.parent[b] >= 0) CHECK(pose.frames[b].dot(pose.frames[tree.parent[b]]) > 0.0);
    }
}

Vec3 randomVector(std::mt19937& random, double size) {
    std::uniform_real_distribution<double> d(-size, size);
    const double x = d(random), y = d(random), z = d(random);
    return {x, y, z};
}

}  // namespace

TEST_CASE("inverse kinematics: without holds nothing moves") {
    const Skeleton s = chain(5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    pose.points[3].y() = 0.7;
    const Pose before = pose;
    CHECK(ik.solve({}, pose).converged);
    CHECK(largestMove(before, pose) == 0.0);
}

TEST_CASE("inverse kinematics: holds at rest leave the pose of rest") {
    const Skeleton s = octopus(8, 5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    std::vector<IkGoal> goals;
    for (const int p : {0, 6, 11, 41}) goals.push_back({p, s.points[p]});
    const auto report = ik.solve(goals, pose);
    CHECK(report.converged);
    CHECK(largestMove(restPose(s), pose) < 1e-12);
    CHECK(largestTurn(restPose(s), pose) < 1e-7);
}

TEST_CASE("inverse kinematics: a reachable target is reached, after small and after large drags") {
    const Skeleton s = chain(5);
    for (const Vec3& to : {Vec3(4.9, 0.3, 0), Vec3(3, 2, 1), Vec3(0.5, 0.5, 0), Vec3(-4, 1, 0), Vec3(-4, 0, 0), Vec3(0, 0, 3), Vec3(9, 0, 0), Vec3(2, 0, 0)}) {
        CAPTURE(to.transpose());
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        const std::vector<IkGoal> goals = {{0, Vec3(0, 0, 0)}, {5, to}};
        InverseKinematics::Report report;
        const int solves = settle(ik, goals, pose, report);
        CHECK(solves <= 200);
        CHECK(report.largestMiss < 1e-6);
        CHECK_FALSE(report.outOfReach);
        checkFramesFollowBones(s, pose);
    }
}

TEST_CASE("inverse kinematics: a target out of reach is approached to the stretch limits") {
    const Skeleton s = chain(5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    InverseKinematics::Report report;
    CHECK(settle(ik, {{0, Vec3(0, 0, 0)}, {5, Vec3(0, 1e7, 0)}}, pose, report) <= 200);
    CHECK(report.outOfReach);
    CHECK(report.finite);
    // Five bones of length 1, limit 2, one percent of slack at the full force of a hold.
    CHECK(pose.points[5].y() == doctest::Approx(10.0).epsilon(0.02));
    CHECK(pose.points[5].head<1>().norm() < 0.01);
    // And back.
    CHECK(settle(ik, {{0, Vec3(0, 0, 0)}, {5, Vec3(5, 0, 0)}}, pose, report) <= 200);
    CHECK(report.largestMiss < 1e-6);
}

TEST_CASE("inverse kinematics: an unpinned body follows the dragged end") {
    const Skeleton s = chain(5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    InverseKinematics::Report report;
    for (int i = 1; i <= 400; ++i) report = ik.solve({{5, Vec3(5, 0.05 * i, 0)}}, pose);
    CHECK(report.largestMiss < 1e-3);
    // The body trails behind the head along the way it was dragged.
    CHECK(pose.points[0].y() < pose.points[5].y() - 4.0);
    CHECK(std::abs(pose.points[0].x() - 5.0) < 1.0);
    for (int b = 0; b < 5; ++b) CHECK((pose.points[b + 1] - pose.points[b]).norm() == doctest::Approx(1.0).epsilon(0.1));
}

TEST_CASE("inverse kinematics: degenerate input stays finite") {
    const double big = std::numeric_limits<double>::max();
    const std::vector<std::vector<IkGoal>> cases = {
        {{0, Vec3(0, 0, 0)}, {5, Vec3(0, 0, 0)}},                                   // all at one place
        {{2, Vec3(1, 1, 1)}, {3, Vec3(1, 1, 1)}},                                   // both ends of one bone
        {{2, Vec3(-50, 0, 0)}, {3, Vec3(50, 0, 0)}},                                // incompatible
        {{0, Vec3(0, 0, 0)}, {1, Vec3(0, 0, 0)}, {2, Vec3(0, 0, 0)}, {3, Vec3(0, 0, 0)}, {4, Vec3(0, 0, 0)}, {5, Vec3(0, 0, 0)}},
        {{0, Vec3(0, 0, 0)}, {5, Vec3(big, -big, big)}},                            // at the end of the world
        {{0, Vec3(-big, 0, 0)}, {5, Vec3(big, 0, 0)}},
        {{5, Vec3(1, 0, 0)}, {5, Vec3(2, 0, 0)}},                                   // twice the same point
    };
    for (const auto& goals : cases) {
        const Skeleton s = chain(5);
        InverseKinematics ik(s);
        for (const bool collapsed : {false, true}) {
            Pose pose = restPose(s);
            if (collapsed)
                for (auto& p : pose.points) p.setZero();
            for (int i = 0; i < 150; ++i) CHECK(ik.solve(goals, pose).finite);
            CHECK(finite(pose));
            for (const auto& b : s.bones) CHECK((pose.points[b.end] - pose.points[b.start]).norm() > 0.4);
        }
    }
}

TEST_CASE("inverse kinematics: what is not a number is refused and the pose kept") {
    const Skeleton s = chain(3);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(ik.solve({{3, Vec3(nan, 0, 0)}}, pose).finite);
    CHECK_FALSE(ik.solve({{7, Vec3(0, 0, 0)}}, pose).finite);
    CHECK(largestMove(pose, restPose(s)) == 0.0);
    CHECK(ik.solve({{3, Vec3(3, 1, 0)}}, pose).finite);
    pose.points[1].x() = nan;
    CHECK_FALSE(ik.solve({{3, Vec3(3, 1, 0)}}, pose).finite);
}

TEST_CASE("inverse kinematics: one bone pinned at its start turns round when the target passes through the pin") {
    const Skeleton s = chain(1);
    InverseKinematics ik(s);
    Pose pose = restPose(s), last = pose;
    for (int i = 0; i <= 200; ++i) {
        ik.solve({{0, Vec3::Zero()}, {1, Vec3(1 - 0.01 * i, 0, 0)}}, pose);
        CHECK(largestMove(last, pose) <= InverseKinematics::kMotionGain * 0.01 + InverseKinematics::kTrustRadius + 1e-12);
        last = pose;
    }
    InverseKinematics::Report report;
    settle(ik, {{0, Vec3::Zero()}, {1, Vec3(-1, 0, 0)}}, pose, report);
    CHECK(report.largestMiss < 1e-6);
}

TEST_CASE("inverse kinematics: no joint point and no frame jumps in a random walk out of reach, through folds and through joints") {
    for (const unsigned seed : {1u, 2u, 3u}) {
        CAPTURE(seed);
        const Skeleton s = chain(5);
        InverseKinematics ik(s), again(s);
        Pose pose = restPose(s), same = pose;
        std::mt19937 random(seed);
        Vec3 target(5, 0, 0), velocity = Vec3::Zero();
        const double step = 0.05;  // one percent of the length
        const double limit = InverseKinematics::kMotionGain * step + InverseKinematics::kTrustRadius;
        double turn = 0.0;
        bool fits = true, bytes = true;
        for (int i = 0; i < 10000; ++i) {
            velocity = (velocity + randomVector(random, 0.5)).normalized();
            // Every now and then home through the pinned tail and the other joints, or far away.
            if (i % 1500 > 1100) velocity = (pose.points[i % 3] - target + 1e-3 * velocity).normalized();
            if (target.norm() > 40.0) velocity = -target.normalized();
            target += step * velocity;
            const Pose last = pose;
            const auto report = ik.solve({{0, Vec3::Zero()}, {5, target}}, pose);
            again.solve({{0, Vec3::Zero()}, {5, target}}, same);
            fits = fits && report.finite && finite(pose) && largestMove(last, pose) <= limit * (1 + 1e-9);
            bytes = bytes && pose.points == same.points;
            turn = std::max(turn, largestTurn(last, pose));
        }
        CHECK(fits);
        CHECK(bytes);
        // Turns count as moves of a bone's tip about its start; roots may return towards rest by half as much on top.
        CHECK(turn <= 1.5 * limit + 1e-6);
        checkFramesFollowBones(s, pose);
    }
}

TEST_CASE("inverse kinematics: small drags that are each solved until they settle do not jump either, and arrive") {
    for (const int pin : {0, 2}) {
        CAPTURE(pin);
        const Skeleton s = chain(5);
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        std::mt19937 random(5);
        Vec3 target(5, 0, 0), velocity = Vec3::Zero();
        const double step = 0.05;
        double move = 0.0, turn = 0.0, miss = 0.0;
        int most = 0;
        for (int i = 0; i < 800; ++i) {
            velocity = (velocity + randomVector(random, 0.5)).normalized();
            if (i % 200 > 120) velocity = (pose.points[i % 3] - target + 1e-3 * velocity).normalized();
            target += step * velocity;
            const Pose last = pose;
            InverseKinematics::Report report;
            most = std::max(most, settle(ik, {{pin, s.points[pin]}, {5, target}}, pose, report));
            move = std::max(move, largestMove(last, pose));
            turn = std::max(turn, largestTurn(last, pose));
            if (!report.outOfReach) miss = std::max(miss, report.largestMiss);
        }
        CHECK(most <= 200);
        // Ten steps are what an artist would call a jump.
        CHECK(move < 10 * step);
        CHECK(turn < 10 * step);
        CHECK(miss < 0.1);
    }
}

TEST_CASE("inverse kinematics: an octopus with several pins and drags reaches all of them") {
    const Skeleton s = octopus(8, 5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    std::vector<IkGoal> goals = {{0, s.points[0]}, {6, s.points[6]}, {11, s.points[11]}, {16, s.points[16]}, {41, s.points[41]}};
    InverseKinematics::Report report;
    for (int i = 1; i <= 60; ++i) {
        goals[1].target = s.points[6] + 0.03 * i * Vec3(0, 1, 0);
        goals[2].target = s.points[11] - 0.02 * i * Vec3(1, 0, 1);
        goals[3].target = s.points[16] + 0.01 * i * Vec3(1, 2, -1);
        report = ik.solve(goals, pose);
        CHECK(report.finite);
    }
    CHECK(settle(ik, goals, pose, report) <= 200);
    CHECK(report.largestMiss < 1e-6);
    checkFramesFollowBones(s, pose);
}

TEST_CASE("inverse kinematics: settles for any targets within 200 solves") {
    CHECK(rc::check("random holds on an octopus", [] {
        const Skeleton s = octopus(6, 4);
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        std::mt19937 random(*rc::gen::arbitrary<unsigned>());
        std::vector<IkGoal> goals;
        const int count = *rc::gen::inRange(1, 6);
        for (int i = 0; i < count; ++i)
            goals.push_back({static_cast<int>(random() % s.points.size()), randomVector(random, *rc::gen::element(0.5, 2.0, 10.0))});
        InverseKinematics::Report report;
        const int solves = settle(ik, goals, pose, report);
        RC_ASSERT(report.finite);
        RC_ASSERT(solves <= 200);
    }));
}

TEST_CASE("inverse kinematics: a straight chain that is pushed along its axis squashes and stays straight, and folds once its bones are nearly at their shortest") {
    const auto bow = [](const Skeleton& s, const Pose& pose) {
        double along = 0.0;
        for (const auto& b : s.bones) along += (pose.points[b.end] - pose.points[b.start]).norm();
        return 1.0 - (pose.points.back() - pose.points.front()).norm() / along;
    };
    for (const int bones : {2, 5, 20}) {
        for (const int steps : {1, 7, 400}) {
            CAPTURE(bones);
            CAPTURE(steps);
            const Skeleton s = chain(bones);
            InverseKinematics ik(s);
            Pose pose = restPose(s), last = pose;
            InverseKinematics::Report report;
            double bowed = 0.0, jumped = 0.0;
            // By 40 %, one percent of the length off the axis.
            for (int i = 1; i <= steps; ++i) {
                const double part = double(i) / steps;
                report = ik.solve({{0, Vec3::Zero()}, {bones, bones * Vec3(1.0 - 0.4 * part, 0.01 * part, 0)}}, pose);
                bowed = std::max(bowed, bow(s, pose));
                jumped = std::max(jumped, largestMove(last, pose));
                last = pose;
            }
            const double step = 0.4 * bones / steps;
            CHECK(jumped <= InverseKinematics::kMotionGain * 1.01 * step + InverseKinematics::kTrustRadius);
            const std::vector<IkGoal> squashed = {{0, Vec3::Zero()}, {bones, bones * Vec3(0.6, 0.01, 0)}};
            CHECK(settle(ik, squashed, pose, report) <= 200);
            MESSAGE(bones << " bones, " << steps << " steps: bow " << bowed << ", then " << bow(s, pose) << ", misses by " << report.largestMiss);
            // On the way many bones lag behind the end that goes aside.
            CHECK(bowed < (bones > 5 ? 0.01 : 1e-5));
            CHECK(bow(s, pose) < 2e-5);
            CHECK(report.largestMiss < 1e-6);
            // Another solver, that did not see how the pose came about, leaves it.
            InverseKinematics fresh(s);
            Pose kept = pose;
            CHECK(fresh.solve(squashed, kept).finite);
            CHECK(largestMove(pose, kept) < 1e-3);
            // Its end may be led round, squashed as it is.
            for (int i = 1; i <= 200; ++i) ik.solve({{0, Vec3::Zero()}, {bones, 0.6 * bones * Vec3(std::cos(0.005 * i), std::sin(0.005 * i), 0)}}, pose);
            CHECK(settle(ik, {{0, Vec3::Zero()}, {bones, 0.6 * bones * Vec3(std::cos(1.0), std::sin(1.0), 0)}}, pose, report) <= 200);
            CHECK(bow(s, pose) < (bones > 5 ? 0.01 : 1e-5));
            // It folds between there and the shortest of its bones.
            const double least = s.bones[0].minStretch;
            for (const double part : {least + AxialSquash::kReserve, least - 0.03}) {
                settle(ik, {{0, Vec3::Zero()}, {bones, part * bones * Vec3(std::cos(1.0), std::sin(1.0), 0)}}, pose, report);
                CHECK((bow(s, pose) > 0.05) == (part < least));
                CHECK(report.largestMiss < 1e-5);
            }
            // And back, straight, with bones as long as at rest.
            settle(ik, {{0, Vec3::Zero()}, {bones, Vec3(bones, 0, 0)}}, pose, report);
            CHECK(largestMove(restPose(s), pose) < 1e-3);
        }
    }
    // Pulled aside it bends, and its bones keep their lengths, whatever the steps; so does a chain whose bones may not shorten.
    for (const int steps : {1, 10, 300}) {
        CAPTURE(steps);
        Skeleton s = chain(5);
        for (const bool stiff : {false, true}) {
            if (stiff)
                for (auto& b : s.bones) b.minStretch = 1.0;
            InverseKinematics ik(s);
            Pose pose = restPose(s);
            InverseKinematics::Report report;
            std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {5, Vec3(5, 0, 0)}};
            for (int i = 1; i <= steps; ++i) {
                goals[1].target = Vec3(5, 0, 0) + (double(i) / steps) * (stiff ? Vec3(-1.5, 0, 0) : Vec3(-1.5, 1.5, 0));
                ik.solve(goals, pose);
            }
            settle(ik, goals, pose, report);
            for (const auto& b : s.bones) CHECK((pose.points[b.end] - pose.points[b.start]).norm() > 0.95);
        }
    }
}

TEST_CASE("inverse kinematics: turned and shifted input gives the turned and shifted pose") {
    const Skeleton s = chain(4);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()));
    const Vec3 shift(3, -2, 1);
    Skeleton moved = s;
    for (auto& p : moved.points) p = turn * p + shift;
    InverseKinematics one(s), two(moved);
    Pose a = restPose(s), b = restPose(moved);
    for (int i = 1; i <= 30; ++i) {
        const Vec3 to(4 - 0.05 * i, 0.08 * i, 0.02 * i);
        one.solve({{0, Vec3::Zero()}, {4, to}}, a);
        two.solve({{0, shift}, {4, turn * to + shift}}, b);
    }
    // Not to rounding: the side that a compressed bone is pushed to is up, wherever the body points.
    for (std::size_t i = 0; i < a.points.size(); ++i) CHECK((turn * a.points[i] + shift - b.points[i]).norm() < 0.05);
}

TEST_CASE("inverse kinematics: roll spreads evenly between held ends and follows a single one") {
    const Skeleton s = chain(4);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    ik.solve({{0, Vec3::Zero()}, {4, Vec3(4, 0, 0), true, 1.0}}, pose);
    for (int i = 0; i <= 4; ++i) CHECK(pose.roll[i] == doctest::Approx(0.25 * i).epsilon(1e-9));
    const BoneTree tree = boneTree(s);
    CHECK(boneRoll(s, tree, pose, 0) == doctest::Approx(0.125));

    Pose loose = restPose(s);
    ik.solve({{4, Vec3(4, 0, 0), true, 1.0}}, loose);
    for (int i = 0; i <= 4; ++i) CHECK(loose.roll[i] == doctest::Approx(1.0).epsilon(1e-6));

    // A chain that leaves its root both ways turns as one body.
    Skeleton both;
    for (int i = 0; i <= 4; ++i) both.points.emplace_back(i, 0, 0);
    both.bones = {{2, 3, -1, 1.0}, {3, 4, 0, 1.0}, {2, 1, 0, 1.0}, {1, 0, 2, 1.0}};
    InverseKinematics two(both);
    Pose twist = restPose(both);
    two.solve({{0, both.points[0], true, -1.0}, {4, both.points[4], true, 1.0}}, twist);
    const BoneTree bothTree = boneTree(both);
    for (int b = 0; b < 4; ++b) {
        const Vec3 axis = boneRoll(both, bothTree, twist, b) * bothTree.restDirection[b];
        CHECK((axis - Vec3(1, 0, 0)).norm() < 1e-6);
    }
}

TEST_CASE("inverse kinematics: a root that swings through the opposite of rest does not spin, and its roll does not drift") {
    Skeleton s = chain(2);
    InverseKinematics ik(s);
    Pose pose = restPose(s), last = pose;
    double turn = 0.0;
    for (int i = 0; i <= 3000; ++i) {
        const double angle = 0.01 * i;
        const Vec3 d(std::cos(angle), std::sin(angle), 0.05 * std::sin(0.37 * angle));
        ik.solve({{0, -d}, {2, d}}, pose);
        turn = std::max(turn, largestTurn(last, pose));
        last = pose;
    }
    CHECK(turn < 0.1);
    InverseKinematics::Report report;
    settle(ik, {{0, Vec3(0, -1, 0)}, {2, Vec3(0, 1, 0)}}, pose, report);
    const Eigen::Quaterniond minimal = minimalRotation(Vec3::UnitX(), Vec3::UnitY());
    CHECK(pose.frames[0].angularDistance(minimal) < 1e-2);
}

TEST_CASE("inverse kinematics: solve allocates nothing") {
    const Skeleton s = octopus(8, 5);
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    std::vector<IkGoal> goals = {{0, s.points[0]}, {6, s.points[6], true, 0.3}, {11, s.points[11]}};
    ik.solve(goals, pose);
    const auto before = allocations();
    for (int i = 0; i < 20; ++i) {
        goals[1].target.y() += 0.1;
        ik.solve(goals, pose);
    }
    CHECK(allocations() == before);
}

namespace {

// Degrees between a bone and where its parent carries it at rest.
double bendOf(const Skeleton& s, const Pose& pose, int b) {
    const BoneTree tree = boneTree(s);
    const Vec3 carried = pose.frames[tree.parent[b]] * tree.restDirection[b], d = (pose.points[s.bones[b].end] - pose.points[s.bones[b].start]).normalized();
    return std::atan2(carried.cross(d).norm(), carried.dot(d)) * 180.0 / M_PI;
}

}  // namespace

TEST_CASE("inverse kinematics: bend limits are held within a degree or two, whatever pulls, and passing them is smooth") {
    for (const double degrees : {0.0, 10.0, 45.0, 120.0}) {
        CAPTURE(degrees);
        Skeleton s = chain(5), free = s;
        for (const int b : {1, 3}) s.bones[b].maxBend = degrees * M_PI / 180.0;
        double beyond = 0.0, step[2] = {0.0, 0.0};
        for (const bool limited : {false, true}) {
            const Skeleton& of = limited ? s : free;
            InverseKinematics ik(of);
            Pose pose = restPose(of), last = pose;
            // Out of the plane, too, in to the pin, and out of reach.
            for (int i = 0; i <= 900; ++i) {
                const double part = i / 900.0, angle = 2.0 * M_PI * part, reach = 5.0 - 4.5 * std::sin(3.0 * M_PI * part) * std::sin(3.0 * M_PI * part) + (part > 0.7 ? 4.0 * (part - 0.7) : 0.0);
                ik.solve({{0, Vec3::Zero()}, {5, reach * Vec3(std::cos(angle), std::sin(angle), 0.2 * std::sin(3.0 * angle))}}, pose);
                REQUIRE(finite(pose));
                for (const int b : {1, 3})
                    if (limited) beyond = std::max(beyond, bendOf(s, pose, b) - degrees);
                step[limited] = std::max(step[limited], largestMove(last, pose));
                last = pose;
            }
        }
        MESSAGE(degrees << " degrees: at most " << beyond << " beyond; largest step " << step[1] << ", without limits " << step[0]);
        CHECK(beyond < 2.0);
        CHECK(step[1] <= 1.5 * step[0]);
    }
}

TEST_CASE("inverse kinematics: twist limits are held within a degree or two, the other bones take what they leave, and beyond that the goal gives way") {
    Skeleton s = chain(4);
    s.bones[1].maxTwist = 20.0 * M_PI / 180.0;
    InverseKinematics ik(s);
    Pose pose = restPose(s), last = pose;
    const auto twist = [&](int b) { return (pose.roll[b + 1] - pose.roll[b]) * 180.0 / M_PI; };
    double jump = 0.0;
    for (int i = 0; i <= 400; ++i) {
        ik.solve({{0, Vec3::Zero()}, {4, Vec3(4, 0, 0), true, 0.02 * i}}, pose);
        for (int p = 0; p <= 4; ++p) jump = std::max(jump, std::abs(pose.roll[p] - last.roll[p]));
        last = pose;
    }
    CHECK(pose.roll[4] == doctest::Approx(8.0).epsilon(1e-6));
    CHECK(twist(1) < 21.0);
    CHECK(twist(1) > 19.9);
    for (const int b : {0, 3}) CHECK(twist(b) == doctest::Approx(twist(2)).epsilon(1e-6));
    // No point turns by more than the goal does.
    CHECK(jump < 1.001 * 0.02);
    MESSAGE("a chain twisted by 458 degrees: the bone limited to 20 has " << twist(1) << ", the others " << twist(2));

    for (auto& bone : s.bones) bone.maxTwist = 30.0 * M_PI / 180.0;
    InverseKinematics all(s);
    pose = restPose(s);
    for (int i = 0; i <= 100; ++i) all.solve({{0, Vec3::Zero()}, {4, Vec3(4, 0, 0), true, 12.6 * std::sin(0.5 * M_PI * i / 100.0)}}, pose);
    for (int b = 0; b < 4; ++b) CHECK(std::abs(twist(b) - 31.0) < 1.0);
    // And back.
    all.solve({{0, Vec3::Zero()}, {4, Vec3(4, 0, 0), true, 0.4}}, pose);
    for (int i = 0; i <= 4; ++i) CHECK(pose.roll[i] == doctest::Approx(0.1 * i).epsilon(1e-6));
}

TEST_CASE("inverse kinematics: soft bones give way before stiff ones") {
    Skeleton s = chain(6);
    for (int b = 0; b < 3; ++b) s.bones[b].stiffness = 100.0;
    InverseKinematics ik(s);
    Pose pose = restPose(s);
    InverseKinematics::Report report;
    // Three held points, so that the stiff half cannot turn about its end.
    CHECK(settle(ik, {{0, Vec3::Zero()}, {1, Vec3(1, 0, 0)}, {6, Vec3(4, 3, 0)}}, pose, report) <= 200);
    CHECK(report.largestMiss < 1e-5);
    double stiff = 0.0, soft = 0.0;
    for (const int b : {1, 2}) stiff = std::max(stiff, bendOf(s, pose, b));
    for (const int b : {3, 4, 5}) soft = std::max(soft, bendOf(s, pose, b));
    MESSAGE("stiff joints bend by " << stiff << " degrees, soft ones by " << soft);
    CHECK(stiff < 2.0);
    CHECK(soft > 20.0);
}

TEST_CASE("inverse kinematics: a bone that is held as it points stays so within a degree while the rest is dragged anywhere") {
    const Skeleton s = chain(5);
    InverseKinematics ik(s);
    Pose pose = restPose(s), last = pose;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Vec3::UnitZ()));
    const IkGoal pin{0, Vec3::Zero(), false, 0.0, true, 0, turn};
    double off = 0.0, jumped = 0.0;
    for (int i = -100; i <= 600; ++i) {
        const double angle = 0.5 + 2.0 * M_PI * std::max(i, 0) / 600.0;
        const IkGoal drag{5, Vec3(4.5 * std::cos(angle), 4.5 * std::sin(angle), 0)};
        ik.solve({pin, drag}, pose);
        const double degrees = std::acos(std::min(1.0, (pose.points[1] - pose.points[0]).normalized().dot(turn * Vec3::UnitX()))) * 180.0 / M_PI;
        if (i > 0) off = std::max(off, degrees), jumped = std::max(jumped, largestMove(last, pose));
        last = pose;
        REQUIRE(finite(pose));
    }
    MESSAGE("a held bone is off by at most " << off << " degrees");
    CHECK(off < 1.0);
    CHECK(jumped < 10 * 4.5 * 2.0 * M_PI / 600.0);
    CHECK_FALSE(ik.solve({{0, Vec3::Zero(), false, 0.0, true, 9, turn}}, pose).finite);
}

TEST_CASE("inverse kinematics: a bone that points away from the direction that it is held in turns round") {
    const Skeleton s = chain(4);
    for (const double degrees : {170.0, 179.99, 179.999999, 180.0}) {
        CAPTURE(degrees);
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * M_PI / 180.0, Vec3::UnitZ()));
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        InverseKinematics::Report report;
        CHECK(settle(ik, {{0, Vec3::Zero(), false, 0.0, true, 0, turn}, {4, turn * Vec3(4, 0, 0)}}, pose, report) <= 200);
        CHECK((pose.points[1] - pose.points[0]).normalized().dot(turn * Vec3::UnitX()) > std::cos(M_PI / 180.0));
        CHECK(report.largestMiss < 1e-5);
    }
}

TEST_CASE("inverse kinematics: a drag goes the same way at 60, 120 and 240 frames a second, not only to the same end") {
    constexpr double kDrag = 0.5;                             // s, along an arc
    constexpr double kLooks[] = {0.1, 0.2, 0.3, 0.5, 1.5};    // s: on the way, at its end, and at rest
    struct Drag {
        const char* what;
        Skeleton skeleton;
        int end;
        double far;
        bool pinned;
    };
    const Drag drags[] = {{"a pinned chain", chain(8), 8, 2.0, true},
                          {"a chain that trails", chain(8), 8, 2.0, false},
                          {"an arm of a pinned octopus", octopus(6, 4), 5, 1.0, true},
                          {"an octopus that follows its arm", octopus(6, 4), 5, 1.0, false}};
    for (const Drag& drag : drags) {
        const std::string what = drag.what;
        CAPTURE(what);
        const Skeleton& s = drag.skeleton;
        const auto target = [&](double seconds) {
            const double angle = 0.5 * M_PI * std::min(1.0, seconds / kDrag);
            return Vec3(s.points[static_cast<std::size_t>(drag.end)] + drag.far * (Vec3(std::cos(angle) - 1.0, 0, 0) + std::sin(angle) * Vec3(0, 0.6, 0.8)));
        };
        // All points at these times; `step`: what each frame is said to last, in s.
        const auto way = [&](int hertz, double step) {
            InverseKinematics ik(s);
            Pose pose = restPose(s);
            std::vector<Pose> seen;
            for (int i = 1; seen.size() < std::size(kLooks); ++i) {
                std::vector<IkGoal> goals = {{drag.end, target(double(i) / hertz)}};
                if (drag.pinned) goals.push_back({0, s.points[0]});
                REQUIRE(ik.solve(goals, pose, step).finite);
                if (std::abs(i - kLooks[seen.size()] * hertz) < 0.5) seen.push_back(pose);
            }
            return seen;
        };
        const auto usual = way(60, 1.0 / 60.0);
        for (const int hertz : {120, 240}) {
            CAPTURE(hertz);
            const auto now = way(hertz, 1.0 / hertz), perCall = way(hertz, 1.0 / 60.0);
            // A frame of 1/60 s brings at once what shorter ones bring bit by bit: half of its way, on average.
            const double bound = 0.5 * (target(1.0 / 60.0) - target(0.0)).norm();
            double off = 0.0, was = 0.0;
            for (std::size_t k = 0; k < std::size(kLooks); ++k) {
                CAPTURE(kLooks[k]);
                CHECK(largestMove(usual[k], now[k]) <= bound);
                off = std::max(off, largestMove(usual[k], now[k]));
                was = std::max(was, largestMove(usual[k], perCall[k]));
            }
            MESSAGE(what << ", " << hertz << " Hz: at most " << off << " of a bone beside the way at 60 Hz; with constants per frame " << was);
        }
    }
}

TEST_CASE("inverse kinematics: frames of any length settle, and mouse moves that come more seldom than frames lead the same way") {
    const Skeleton s = octopus(6, 4);
    for (const double seconds : {1e-16, 1.0 / 1000.0, 1.0 / 240.0, 1.0 / 144.0, 1.0 / 50.0, 1.0 / 30.0, 0.5, 10.0}) {
        CAPTURE(seconds);
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        InverseKinematics::Report report;
        CHECK(settleIn(ik, {{0, s.points[0]}, {5, s.points[5] + Vec3(-1.0, 0.6, 0.8)}}, pose, report, seconds));
        CHECK(report.largestMiss < 1e-5);
        checkFramesFollowBones(s, pose);
    }
    const auto dragged = [&](int framesOfMove) {
        InverseKinematics ik(s);
        Pose pose = restPose(s);
        for (int move = 1; move <= 30; ++move)
            for (int i = 0; i < framesOfMove; ++i) ik.solve({{0, s.points[0]}, {5, s.points[5] + move / 30.0 * Vec3(-1.0, 0.6, 0.8)}}, pose, 1.0 / 60.0 / framesOfMove);
        return pose;
    };
    const Pose usual = dragged(1);
    for (const int frames : {2, 4}) {
        MESSAGE(frames << " frames of each move: " << largestMove(usual, dragged(frames)) << " of a bone beside one");
        CHECK(largestMove(usual, dragged(frames)) <= std::sqrt(2.0) / 30.0);
    }
}
