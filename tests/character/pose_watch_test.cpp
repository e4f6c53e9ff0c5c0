// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include "core/character/character.h"
#include "core/effects/bend_warp_job.h"
#include "core/skeleton/inverse_kinematics.h"
#include "tests/character/caterpillar.h"
#include "tests/character/embedded.h"
#include "tests/character/full_joints.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

CharacterInput watchedChain(double radius, bool automatic, int elements = 4) {
    caterpillar::Shape shape;
    shape.elements = elements;
    shape.radius = radius;
    shape.around = {14};
    shape.along = {7};
    shape.tips = true;
    shape.basis = {BasisKind::Affine, 0};
    shape.mirrored = true;
    CharacterInput input = caterpillar::make(shape);
    BendWarpEffect warp;
    warp.automatic = true;
    if (automatic) input.effects.set(warp);
    return input;
}

double volumeOf(const Points& p, const Triangles& triangles) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Vec3 a = p.row(triangles(t, 0)).transpose(), b = p.row(triangles(t, 1)).transpose(), c = p.row(triangles(t, 2)).transpose();
        sum += a.dot(b.cross(c)) / 6.0;
    }
    return sum;
}

struct Truth {
    double area = 1.0, depth = 1.0, volume = 0.0;
};

/// Of all triangles and vertices, as they are shown.
Truth truthOf(const Character& c, int e) {
    const auto& given = c.input().elements[static_cast<std::size_t>(e)];
    const auto& body = given.mesh->body;
    const Points now = c.positions(e);
    Truth out;
    std::vector<char> held(static_cast<std::size_t>(body.vertices.rows()), 0);
    for (const auto& face : given.faces)
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    const Eigen::Matrix3d own = c.frame(e).linear();
    // Joint planes turn by half of what bones do, at the ends by all of it.
    const auto turnOf = [&](std::size_t f) -> Eigen::Matrix3d {
        const auto& v = given.faces[f].vertices;
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const auto i : v)
            sum += (now.row(i) - now.row(v[0])).transpose() * (body.vertices.row(i) - body.vertices.row(v[0]));
        const Vec3 n = given.faces[f].frame.axes.col(2);
        Vec3 shown = Vec3::Zero();
        for (const auto t : given.faces[f].triangles) {
            const Vec3 a = now.row(body.triangles(t, 0)).transpose(), b = now.row(body.triangles(t, 1)).transpose(), d = now.row(body.triangles(t, 2)).transpose();
            shown += (b - a).cross(d - a);
        }
        return Eigen::Quaterniond::FromTwoVectors(own * n, shown.normalized()).toRotationMatrix() * own;
    };
    std::vector<Eigen::Matrix3d> turns;
    for (std::size_t f = 0; f < given.faces.size(); ++f) turns.push_back(turnOf(f));
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        const auto corner = [&](const Points& p, int k) -> Vec3 { return p.row(body.triangles(t, k)).transpose(); };
        if (held[body.triangles(t, 0)] && held[body.triangles(t, 1)] && held[body.triangles(t, 2)]) continue;
        const Vec3 n0 = (corner(body.vertices, 1) - corner(body.vertices, 0)).cross(corner(body.vertices, 2) - corner(body.vertices, 0));
        const Vec3 n = (corner(now, 1) - corner(now, 0)).cross(corner(now, 2) - corner(now, 0)) / n0.norm();
        double seen = n.dot(own * n0.normalized());
        for (const auto& turn : turns) {
            const Vec3 whole = turn * n0.normalized(), half = (whole + own * n0.normalized()).normalized();
            seen = std::max({seen, n.dot(whole), n.dot(half)});
        }
        out.area = std::min(out.area, seen);
    }
    for (std::size_t f = 0; f < given.faces.size(); ++f) {
        const auto& frame = given.faces[f].frame;
        const Vec3 n = turns[f] * frame.axes.col(2);
        Vec3 origin = Vec3::Zero();
        for (const auto v : given.faces[f].vertices) origin += now.row(v).transpose() / static_cast<double>(given.faces[f].vertices.size());
        for (Eigen::Index v = 0; v < now.rows(); ++v) {
            const double rest = -frame.axes.col(2).dot(body.vertices.row(v).transpose() - frame.origin);
            if (held[static_cast<std::size_t>(v)] || rest < 0.08 * given.faces[f].size) continue;
            out.depth = std::min(out.depth, n.dot(origin - now.row(v).transpose()) / rest);
        }
    }
    // Bones keep their length here: the volume at rest is that of the body.
    out.volume = volumeOf(now, body.triangles) / volumeOf(body.vertices, body.triangles) - 1.0;
    return out;
}

Pose randomPose(const Skeleton& skeleton, std::mt19937& random, double most) {
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    Pose pose = restPose(skeleton);
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const Vec3 axis = Vec3(one(random), one(random), 0.3 * one(random)).normalized();
        if (b > 0) turn = turn * Eigen::Quaterniond(Eigen::AngleAxisd(most * one(random), axis));
        pose.frames[b] = turn;
        pose.points[b + 1] = pose.points[b] + turn * (skeleton.points[b + 1] - skeleton.points[b]);
    }
    return pose;
}

/// Every joint bent by so much.
Pose rolledUp(const Skeleton& skeleton, double each) {
    Pose pose = restPose(skeleton);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(each * static_cast<double>(b), Vec3::UnitX()));
        pose.frames[b] = turn;
        pose.points[b + 1] = pose.points[b] + turn * (skeleton.points[b + 1] - skeleton.points[b]);
    }
    return pose;
}

}  // namespace

TEST_CASE("pose watch: at rest and moved as it is an element calls for nothing") {
    auto c = Character::build(watchedChain(0.4, false)).value();
    Pose pose = restPose(c.input().skeleton);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.5, Vec3(1, 2, 3).normalized()));
    for (auto& p : pose.points) p = turn * p + Vec3(3, 4, 5);
    for (auto& q : pose.frames) q = turn;
    for (const auto& at : {restPose(c.input().skeleton), pose}) {
        c.update(at);
        for (const auto& m : c.measurePose()) {
            CHECK(m.area == doctest::Approx(1.0).epsilon(1e-9));
            CHECK(m.depth == doctest::Approx(1.0).epsilon(1e-9));
            CHECK(std::abs(m.volume) < 1e-9);
            CHECK(m.bend < 1e-6);
            CHECK(m.crease < 1e-6);
            CHECK(PoseWatch::callForWarp(m) == 0.0);
        }
    }
}

TEST_CASE("pose watch: what folds, crosses or loses its volume in random poses is seen, and the warp is called for before") {
    std::mt19937 random(17);
    for (const double radius : {0.25, 0.4, 0.6}) {
        auto c = Character::build(watchedChain(radius, false)).value();
        int left = 0, hits = 0, misses = 0, falseAlarms = 0, stayed = 0, late = 0, called = 0;
        double volumeError = 0.0, seconds = 0.0;
        for (int i = 0; i < 240; ++i) {
            const Pose pose = randomPose(c.input().skeleton, random, 1.9 * (i + 1) / 240.0);
            c.update(pose);
            const auto start = std::chrono::steady_clock::now();
            const auto measures = c.measurePose();
            if (i > 0) seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / (239 * 4);
            for (int e = 0; e < 4; ++e) {
                const Truth truth = truthOf(c, e);
                const auto& m = measures[static_cast<std::size_t>(e)];
                const bool leaves = truth.area <= 0.0 || truth.depth <= 0.0 || std::abs(truth.volume) > 0.02;
                const bool seen = m.area <= 0.0 || m.depth <= 0.0 || std::abs(m.volume) > 0.02;
                left += leaves, stayed += !leaves;
                hits += leaves && seen, misses += leaves && !seen, falseAlarms += !leaves && seen;
                const double call = PoseWatch::callForWarp(m);
                late += leaves && call < 1.0;
                called += !leaves && call > 0.0;
                if (std::abs(truth.volume) < 0.05) volumeError = std::max(volumeError, std::abs(truth.volume - m.volume));
            }
        }
        MESSAGE("radius ", radius, ": ", left, " of ", left + stayed, " leave; hits ", hits, ", misses ", misses, ", false alarms ", falseAlarms, "; called for late ", late,
                ", called for early ", called, "; error of volume ", volumeError, "; ", 1e6 * seconds, " us per element");
        CHECK(left > 80);
        CHECK(stayed > 200);
        CHECK(misses <= left / 12);
        CHECK(falseAlarms <= stayed / 50);
        CHECK(late == 0);
    }
}

TEST_CASE("automatic bend warp: from straight to rolled up and back nothing folds, nothing jumps, and straight it costs nothing") {
    const int frames = 600;
    auto plain = Character::build(watchedChain(0.4, false, 8)).value(), automatic = Character::build(watchedChain(0.4, true, 8)).value();
    const auto& skeleton = plain.input().skeleton;
    std::vector<Points> before[2];
    std::vector<Points> localBefore[2];
    double step[2] = {0.0, 0.0}, localStep[2] = {0.0, 0.0}, volume[2] = {0.0, 0.0}, area[2] = {1.0, 1.0}, depth[2] = {1.0, 1.0};
    int straight = 0, warped = 0;
    for (int f = 0; f <= frames; ++f) {
        // Both ends meet: 7 joints of 2 pi / 8.
        const double part = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * f / frames);
        const Pose pose = rolledUp(skeleton, part * 2.0 * std::numbers::pi / 8.0);
        for (int k = 0; k < 2; ++k) {
            Character& c = k == 0 ? plain : automatic;
            const std::size_t had = allocations();
            c.update(pose, 1.0 / 60.0);
            REQUIRE(allocations() == had);
            std::vector<Points> now, local;
            for (int e = 0; e < 8; ++e) {
                now.push_back(c.positions(e));
                local.push_back((c.frame(e).inverse() * now.back().transpose()).transpose());
                if (f > 0) localStep[k] = std::max(localStep[k], (local.back() - localBefore[k][static_cast<std::size_t>(e)]).rowwise().norm().maxCoeff());
                if (f > 0) step[k] = std::max(step[k], (now.back() - before[k][static_cast<std::size_t>(e)]).rowwise().norm().maxCoeff());
                if (f % 10 != 0) continue;
                const Truth truth = truthOf(c, e);
                area[k] = std::min(area[k], truth.area);
                depth[k] = std::min(depth[k], truth.depth);
                volume[k] = std::max(volume[k], std::abs(truth.volume));
            }
            before[k] = std::move(now);
            localBefore[k] = std::move(local);
        }
        double most = 0.0;
        for (int e = 0; e < 8; ++e) most = std::max(most, automatic.warpPart(e));
        warped += most > 0.0;
        if (most > 0.0) continue;
        ++straight;
        // The same bytes as without the effect.
        for (int e = 0; e < 8; ++e) CHECK(before[0][static_cast<std::size_t>(e)] == before[1][static_cast<std::size_t>(e)]);
    }
    MESSAGE("product: largest step ", step[0], " (in the frames of elements ", localStep[0], "), area ", area[0], ", depth ", depth[0], ", volume off by ", volume[0], "; automatic: ", step[1], " (", localStep[1], "), ", area[1], ", ", depth[1], ", ",
            volume[1], "; ", straight, " frames as without, ", warped, " warped");
    CHECK(straight > 20);
    CHECK(warped > 200);
    CHECK(step[1] < 1.5 * step[0]);
    CHECK(localStep[1] < 1.5 * localStep[0]);
    CHECK(area[1] > 0.0);
    CHECK(depth[1] > 0.0);
    CHECK(volume[1] < 0.02);
}

TEST_CASE("automatic bend warp: a render mesh is the product while straight, the warp when strongly bent, and passes from one to the other without a step; what it showed is shown again") {
    const auto made = [](bool warped, bool automatic) {
        CharacterInput input = watchedChain(0.4, automatic, 3);
        if (warped) input.effects.set(BendWarpEffect{});
        embedded::addRenderMesh(input, embedded::tube(0.42, 0.05, 2.95, 24, 60), 1.0);
        return Character::build(input).value();
    };
    auto plain = made(false, false), always = made(true, false), automatic = made(false, true);
    automatic.keepExact(true);
    const auto shown = [](const Character& c) {
        const auto s = c.renderSurface(0);
        return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(s.positions, s.vertices, 3).eval();
    };
    using Shown = decltype(shown(plain));
    const int frames = 150;
    std::vector<Shown> before(3);
    double step[3] = {0.0, 0.0, 0.0};
    int straight = 0, fading = 0, whole = 0;
    std::vector<std::vector<double>> shapes;
    std::vector<Shown> seen;
    for (int f = 0; f <= frames; ++f) {
        const Pose pose = embedded::chainPose(plain.input().skeleton, 1.5 * f / frames, 0.2 * f / frames, 1.0);
        Character* all[] = {&plain, &always, &automatic};
        for (int k = 0; k < 3; ++k) {
            all[k]->update(pose, 1.0 / 60.0);
            const Shown now = shown(*all[k]);
            if (f > 0) step[k] = std::max(step[k], static_cast<double>((now - before[k]).rowwise().norm().maxCoeff()));
            before[k] = now;
        }
        double least = 1.0, most = 0.0;
        for (int e = 0; e < 3; ++e) least = std::min(least, automatic.warpPart(e)), most = std::max(most, automatic.warpPart(e));
        if (most == 0.0) {
            ++straight;
            CHECK(before[2] == before[0]);
        } else if (least == 1.0) {
            ++whole;
            CHECK((before[2] - before[1]).cwiseAbs().maxCoeff() == 0.0f);
        } else {
            ++fading;
        }
        if (f % 10 != 0) continue;
        seen.push_back(before[2]);
        automatic.shape(shapes.emplace_back(static_cast<std::size_t>(automatic.shapeLayout().size())).data());
    }
    MESSAGE("largest step: product ", step[0], ", warp ", step[1], ", automatic ", step[2], "; frames straight ", straight, ", fading ", fading, ", warped ", whole);
    CHECK(straight > 10);
    CHECK(fading > 10);
    CHECK(whole > 10);
    CHECK(step[2] < 1.2 * std::max(step[0], step[1]));
    for (std::size_t i = shapes.size(); i-- > 0;) {
        automatic.show(shapes[i].data());
        CHECK(shown(automatic) == seen[i]);
    }
}

TEST_CASE("automatic bend warp: a straight chain squashed by 40 % along its axis, 1 % off it, stays straight, bulges and keeps its volume to 2 %, without a step on the way") {
    double volume[2] = {0.0, 0.0}, step[2] = {0.0, 0.0};
    CharacterInput made = watchedChain(0.4, false, 5);
    for (auto& element : made.elements) element.nu = 0.49;
    caterpillar::precompute(made);
    for (const bool automatic : {false, true}) {
        if (automatic) {
            BendWarpEffect warp;
            warp.automatic = true;
            made.effects.set(warp);
        }
        Character c = Character::build(made).value();
        const auto& skeleton = c.input().skeleton;
        InverseKinematics ik(skeleton);
        Pose pose = restPose(skeleton);
        std::vector<Points> before(5);
        const int frames = 200;
        for (int f = 0; f <= frames; ++f) {
            const double part = static_cast<double>(f) / frames;
            ik.solve({{0, skeleton.points[0]}, {5, skeleton.points[5] + 5.0 * part * Vec3(0.01, 0, -0.4)}}, pose);
            c.update(pose, 1.0 / 60.0);
            double sum = 0.0, rest = 0.0;
            for (std::size_t e = 0; e < 5; ++e) {
                const auto& body = c.input().elements[e].mesh->body;
                const Points now = c.positions(static_cast<int>(e));
                sum += volumeOf(now, body.triangles);
                rest += volumeOf(body.vertices, body.triangles);
                if (f > 0) step[automatic] = std::max(step[automatic], (now - before[e]).rowwise().norm().maxCoeff());
                before[e] = now;
            }
            volume[automatic] = std::max(volume[automatic], std::abs(sum / rest - 1.0));
        }
        for (const Vec3& p : pose.points) CHECK(Vec3(p - skeleton.points[0]).cross(Vec3(0.01, 0, 0.6).normalized()).norm() < 1e-3);
    }
    MESSAGE("volume off by ", volume[0], ", with automatic bend warp ", volume[1], "; largest steps ", step[0], ", ", step[1]);
    CHECK(volume[1] < 0.02);
    CHECK(step[1] < 1.5 * step[0]);
}
