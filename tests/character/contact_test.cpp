// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/effects/bend_warp_job.h"
#include "core/effects/contact_job.h"
#include "core/effects/touch_job.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/winding_number.h"
#include "tests/character/caterpillar.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

/// A caterpillar whose elements are precomputed for touch. Radius 0.5, length 1 of each element.
CharacterInput touchedCaterpillar(int elements, int around, int along) {
    caterpillar::Shape shape;
    shape.elements = elements;
    shape.around = {around};
    shape.along = {along};
    shape.precomputed = false;
    CharacterInput input = caterpillar::make(shape);
    for (auto& element : input.elements) {
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.basis = input.basis;
        in.touch = 48;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
    return input;
}

/// One that is long enough to roll up once and a half.
const CharacterInput& longCaterpillar() {
    static const CharacterInput out = touchedCaterpillar(12, 16, 6);
    return out;
}

/// Each bone is turned by `angle` from the one before it about x, and moved aside, so that turns lie beside each other.
Pose rolled(const Skeleton& skeleton, double angle, double aside) {
    Pose pose = restPose(skeleton);
    Vec3 at = skeleton.points[0];
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const double turn = angle * static_cast<double>(b);
        pose.frames[b] = Eigen::Quaterniond(std::cos(0.5 * turn), std::sin(0.5 * turn), 0.0, 0.0);  // its sign says how often it went round
        at += pose.frames[b] * Vec3(0, 0, skeleton.bones[b].length) + aside * Vec3::UnitX();
        pose.points[b + 1] = at;
    }
    return pose;
}

/// How deep the deepest vertex of an element is in another that is no neighbour, m.
double deepestCrossing(const Character& c) {
    double most = 0.0;
    const auto& elements = c.input().elements;
    std::vector<Points> at;
    for (int e = 0; e < static_cast<int>(elements.size()); ++e) at.push_back(c.positions(e));
    for (std::size_t b = 0; b < at.size(); ++b) {
        TriangleMesh mesh = elements[b].mesh->body;
        mesh.vertices = at[b];
        std::vector<std::int32_t> all(static_cast<std::size_t>(mesh.triangles.rows()));
        std::iota(all.begin(), all.end(), 0);
        const TriangleTree tree(mesh, all);
        for (std::size_t a = 0; a < at.size(); ++a) {
            if (a + 1 >= b && a <= b + 1) continue;
            for (Eigen::Index v = 0; v < at[a].rows(); ++v) {
                const Vec3 p = at[a].row(v).transpose();
                if (std::abs(windingNumber(mesh, p)) >= 0.5) most = std::max(most, std::sqrt(tree.nearest(p).squaredDistance));
            }
        }
    }
    return most;
}

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

TEST_CASE("contact: a caterpillar that is rolled up presses on itself instead of passing through") {
    for (const bool warp : {false, true}) {
        CAPTURE(warp);
        CharacterInput input = longCaterpillar();
        if (warp) input.effects.set(BendWarpEffect{});
        auto plain = Character::build(input).value();
        input.effects.set(ContactEffect{});
        auto c = Character::build(input).value();
        for (int i = 0; i <= 60; ++i) {
            const Pose pose = rolled(input.skeleton, kTurn / 8.0 * i / 60, 0.115 * i / 60);
            plain.update(pose, 1.0 / 60.0);
            c.update(pose, 1.0 / 60.0);
        }
        const double before = deepestCrossing(plain), after = deepestCrossing(c);
        MESSAGE("crossing " << before << " m without contact, " << after << " m with it");
        CHECK(before > 0.1);
        CHECK(after < 0.015);

        // What was seen is what a take shows.
        std::vector<double> numbers(c.shapeLayout().size());
        c.keepExact(true);
        c.update(rolled(input.skeleton, kTurn / 8.0, 0.115), 1.0 / 60.0);
        c.shape(numbers.data());
        std::vector<Points> seen;
        for (int e = 0; e < 12; ++e) seen.push_back(c.positions(e));
        for (int i = 0; i < 10; ++i) c.update(restPose(input.skeleton), 1.0 / 60.0);
        CHECK(c.resting());
        c.show(numbers.data());
        for (int e = 0; e < 12; ++e) CHECK(c.positions(e) == seen[static_cast<std::size_t>(e)]);
    }
}

TEST_CASE("contact: a pose that a frame jumps to presses like one that it came to") {
    CharacterInput input = longCaterpillar();
    ContactEffect effect;
    effect.friction = 0.0;  // which knows where flesh came from
    input.effects.set(effect);
    auto came = Character::build(input).value(), jumped = Character::build(input).value();
    const Pose pose = rolled(input.skeleton, kTurn / 8.0, 0.12);
    jumped.stop();
    jumped.update(pose, 0.0);
    for (int i = 0; i <= 120; ++i) came.update(rolled(input.skeleton, kTurn / 8.0 * std::min(i, 60) / 60, 0.12 * std::min(i, 60) / 60), 1.0 / 60.0);
    double apart = 0.0;
    for (int e = 0; e < 12; ++e) apart = std::max(apart, (came.positions(e) - jumped.positions(e)).rowwise().norm().maxCoeff());
    CHECK(apart <= 1e-4);
}

TEST_CASE("contact: nothing is done while nothing is near") {
    CharacterInput input = longCaterpillar();
    auto plain = Character::build(input).value();
    input.effects.set(ContactEffect{});
    auto c = Character::build(input).value();
    for (int i = 0; i < 20; ++i) {
        const Pose pose = rolled(input.skeleton, 0.01 * (i % 5), 0.0);
        plain.update(pose, 1.0 / 60.0);
        const std::size_t before = allocations();
        c.update(pose, 1.0 / 60.0);
        CHECK(allocations() == before);
        CHECK(c.resting());
        CHECK(c.stats().evaluatedVertices == plain.stats().evaluatedVertices);
        for (int e = 0; e < 12; ++e) REQUIRE(c.positions(e) == plain.positions(e));
    }
}

TEST_CASE("contact: flesh that is pressed on the ground stays above it, whichever way that looks") {
    CharacterInput input = longCaterpillar();
    auto plain = Character::build(input).value();
    ContactEffect effect;
    Vec3 up;
    SUBCASE("up") { up = Vec3::UnitY(); }
    SUBCASE("along the body's own axis") { up = Vec3::UnitZ(); }
    SUBCASE("slanting") { up = Vec3(0.4, -0.7, 0.2); }
    const Plane ground = Plane::through(Vec3(3, -2, 1), up).value();
    effect.ground = ground;
    input.effects.set(effect);
    auto c = Character::build(input).value();
    Pose pose = restPose(input.skeleton);
    const auto lie = [&](double height) {
        const auto side = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), ground.normal());
        for (std::size_t p = 0; p < pose.points.size(); ++p) pose.points[p] = ground.origin() + side * Vec3(0.0, height, static_cast<double>(p));
        for (auto& frame : pose.frames) frame = side;
    };
    const auto lowest = [&](const Character& of) {
        double out = 1.0;
        for (int e = 0; e < 12; ++e) {
            const Points at = of.positions(e);
            for (Eigen::Index v = 0; v < at.rows(); ++v) out = std::min(out, ground.height(at.row(v).transpose()));
        }
        return out;
    };
    lie(0.8);
    c.stop();  // at rest the plane may go through it
    c.update(pose, 1.0 / 60.0);
    CHECK(c.resting());
    for (int i = 0; i <= 60; ++i) {
        lie(0.8 - 0.4 * i / 60);
        plain.update(pose, 1.0 / 60.0);
        c.update(pose, 1.0 / 60.0);
    }
    CHECK(lowest(plain) == doctest::Approx(-0.1).epsilon(1e-3));
    // Rims of joints, which bones place, are left where they are.
    double free = 1.0;
    for (int e = 0; e < 12; ++e) {
        const Points at = c.positions(e);
        const auto held = c.heldVertices(e);
        for (Eigen::Index v = 0; v < at.rows(); ++v)
            if (std::find(held.begin(), held.end(), static_cast<std::int32_t>(v)) == held.end()) free = std::min(free, ground.height(at.row(v).transpose()));
    }
    CHECK(free >= -0.01);
}

TEST_CASE("contact: what lies on the ground and has settled is shown as it is, to the byte, and costs nothing until it moves") {
    CharacterInput input = longCaterpillar();
    ContactEffect effect;
    effect.ground = Plane::level(-0.4);
    input.effects.set(effect);
    auto c = Character::build(input).value();
    Pose pose = restPose(input.skeleton);
    const auto update = [&] { c.update(pose, 1.0 / 60.0); };
    const auto shown = [&] {
        std::vector<Points> out;
        for (int e = 0; e < 12; ++e) out.push_back(c.positions(e));
        return out;
    };
    int frames = 0;
    for (; frames < 120 && !(c.resting() && c.stats().evaluatedVertices == 0 && frames > 0); ++frames) update();
    CHECK(frames < 120);
    const auto settled = shown();
    double lowest = 1.0;
    for (const Points& at : settled) lowest = std::min(lowest, at.col(1).minCoeff());
    for (int i = 0; i < 5; ++i) {
        const std::size_t before = allocations();
        update();
        CHECK(allocations() == before);
        CHECK(c.resting());
        CHECK(c.stats().evaluatedVertices == 0);
        CHECK(shown() == settled);
    }
    const auto revision = c.surface(3).revision;
    update();
    CHECK(c.surface(3).revision == revision);

    // A take in between goes elsewhere; what comes after is as before it.
    std::vector<double> numbers(c.shapeLayout().size()), flat(c.shapeLayout().size());
    c.shape(numbers.data());
    auto other = Character::build(input).value();
    Pose high = pose;
    for (Vec3& p : high.points) p.y() += 2.0;
    other.update(high, 1.0 / 60.0);
    other.shape(flat.data());
    c.show(flat.data());
    CHECK(c.positions(3) == other.positions(3));
    update();
    for (int e = 0; e < 12; ++e) CHECK((c.positions(e) - settled[static_cast<std::size_t>(e)]).cwiseAbs().maxCoeff() <= 1e-3);
    c.show(numbers.data());
    CHECK(shown() == settled);

    // It is pressed farther, and let go.
    for (Vec3& p : pose.points) p.y() -= 0.05;
    update();
    CHECK(c.surface(3).revision > revision);
    for (Vec3& p : pose.points) p.y() += 2.0;
    for (int i = 0; i < 3; ++i) update();
    CHECK(c.resting());
    auto plain = Character::build([&] {
        CharacterInput without = input;
        without.effects = {};
        return without;
    }()).value();
    plain.update(pose, 1.0 / 60.0);
    for (int e = 0; e < 12; ++e) CHECK((c.positions(e) - plain.positions(e)).cwiseAbs().maxCoeff() <= 1e-6);
}

TEST_CASE("contact: where more flesh meets than is looked at, a frame says so") {
    CharacterInput input = touchedCaterpillar(2, 32, 16);
    ContactEffect effect;
    effect.ground = Plane::level(0.0);
    input.effects.set(effect);
    auto c = Character::build(input).value();
    const auto bounded = [&](double height) {
        Pose pose = restPose(input.skeleton);
        for (Vec3& p : pose.points) p.y() += height;
        // Bent a little, so that the two may meet.
        pose.points.back().x() += 0.4;
        pose.frames.back() = Eigen::Quaterniond(Eigen::AngleAxisd(0.38, Vec3::UnitY()));
        c.stop();
        c.update(pose, 1.0 / 60.0);
        return (c.stats().warnings & static_cast<unsigned>(FrameWarning::ContactsBounded)) != 0;
    };
    CHECK_FALSE(bounded(0.45));
    CHECK(bounded(-0.6));
    CHECK_FALSE(bounded(2.0));
}

TEST_CASE("touch: in a frame that is corrected no time passes for fingers") {
    CharacterInput input = touchedCaterpillar(2, 16, 6);
    input.effects.set(TouchEffect{});
    auto c = Character::build(input).value();
    const Pose pose = restPose(input.skeleton);
    const Points rest = c.positions(0);
    const auto corrects = [&] {
        const Points before = c.positions(0);
        CHECK((before - rest).cwiseAbs().maxCoeff() > 1e-3);
        c.correct(pose);
        CHECK((c.positions(0) - before).cwiseAbs().maxCoeff() <= 1e-6);  // single precision of a body of 2 m
    };
    REQUIRE(setFinger(c, 0, 0, Vec3(0.5, 0.0, 0.5), Vec3(0.4, 0.0, 0.5), 0.1));
    c.update(pose, 1.0 / 60.0);  // it is on its way in
    corrects();
    liftFinger(c, 0, 0);
    c.update(pose, 1.0 / 60.0);  // its dent goes back
    corrects();
}
