// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "core/base/finite.h"
#include "core/character/character.h"
#include "core/effects/bend_warp_job.h"
#include "core/effects/body_loads_job.h"
#include "core/effects/joint_dynamics_job.h"
#include "core/effects/smooth_joints_job.h"
#include "tests/support/allocations.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

constexpr double kRadius = 0.22;

/// A ball with handles all over it, precomputed as it is.
CharacterInput ball(int handles, BasisChoice basis = BasisKind::Affine) {
    CharacterInput input;
    input.basis = basis;
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::sphere(1.0, handles > 8 ? 4 : 3).mesh;
    CharacterInput::Element element;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < handles; ++i) {
        const double z = 1.0 - 2.0 * (i + 0.5) / handles, across = std::sqrt(1.0 - z * z);
        const SurfacePoint place = nearestOnSurface(mesh->body, Vec3(across * std::cos(golden * i), across * std::sin(golden * i), z));
        auto face = jointFaceByDisc(mesh->body, place.triangle, place.point, handles > 8 ? 0.8 * kRadius : kRadius);
        REQUIRE_MESSAGE(face.has_value(), (face ? "" : face.error().message));
        REQUIRE(overlappingFace(element.faces, *face) < 0);
        face->name = "handle " + std::to_string(i);
        element.faces.push_back(*face);
        CharacterInput::Joint joint;
        joint.faces.push_back({0, i, -1});
        input.joints.push_back(joint);
        input.handles.push_back({i});
    }
    element.mesh = mesh;
    element.handles = handles;
    ResponseInput in;
    in.mesh = mesh;
    in.faces = element.faces;
    in.basis = basis;
    in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
    auto made = buildResponse(in, {});
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    element.response = std::make_shared<const ElementResponse>(std::move(*made));
    input.elements.push_back(std::move(element));
    return input;
}

Character built(CharacterInput input) {
    auto made = Character::build(std::move(input));
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    return std::move(*made);
}

Vec3 originOf(const Character& c, int handle) { return c.input().elements[0].faces[static_cast<std::size_t>(handle)].frame.origin; }
const Points& restOf(const Character& c) { return c.input().elements[0].mesh->body.vertices; }

Eigen::Quaterniond randomTurn(std::mt19937& random) {
    std::normal_distribution<double> d;
    const double w = d(random), x = d(random), y = d(random), z = d(random);
    return Eigen::Quaterniond(w, x, y, z).normalized();
}

bool finiteSurface(const Character& c) {
    const auto s = c.surface(0);
    return allFinite(s.positions, static_cast<std::size_t>(3 * s.vertices)) && allFinite(s.normals, static_cast<std::size_t>(3 * s.vertices)) &&
           allFinite(c.positions(0)) && allFinite(c.jointParameters(0));
}

}  // namespace

TEST_CASE("handles: at rest the frame is exactly none, and nothing moves but by rounding") {
    const Character c = built(ball(4));
    CHECK((c.frame(0).matrix() - Eigen::Isometry3d::Identity().matrix()).cwiseAbs().maxCoeff() == 0.0);
    CHECK(c.jointParameters(0).cwiseAbs().maxCoeff() < 1e-15);
    CHECK((c.positions(0) - restOf(c)).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("handles: one rigid motion of all handles is that of the body, by any angle, for one handle, four and thirty") {
    std::mt19937 random(1);
    for (const int count : {1, 2, 4, 30}) {
        CAPTURE(count);
        Character c = built(ball(count));
        for (int trial = 0; trial < 6; ++trial) {
            const Eigen::Quaterniond turn = trial == 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Vec3(1, 2, 3).normalized())) : randomTurn(random);
            const Vec3 shift(0.3 * trial, -2.0, 1.0);
            for (int h = 0; h < count; ++h) REQUIRE(c.setHandle(h, {turn * originOf(c, h) + shift, turn, true}));
            c.update({});
            const Points now = c.positions(0);
            double worst = 0.0;
            for (Eigen::Index v = 0; v < now.rows(); ++v) worst = std::max(worst, (Vec3(now.row(v).transpose()) - (turn * Vec3(restOf(c).row(v).transpose()) + shift)).norm());
            CHECK(worst < 1e-12);  // rounding, at a size of 1
            CHECK(c.jointParameters(0).cwiseAbs().maxCoeff() < 1e-12);
        }
    }
}

TEST_CASE("handles: the face of a handle follows its pose bit for bit, and v says the same") {
    Character c = built(ball(4));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.8, Vec3(1, -1, 0.5).normalized()));
    const HandlePose pose{originOf(c, 2) + Vec3(0.2, 0.1, -0.3), turn.normalized(), true};
    REQUIRE(c.setHandle(2, pose));
    c.update({});
    const Eigen::Matrix3d linear = c.handlePose(2).rotation.toRotationMatrix();
    const Vec3 shift = pose.at - linear * originOf(c, 2);
    const JointFace& face = c.input().elements[0].faces[2];
    const ElementResponse& response = *c.input().elements[0].response;
    const Points now = c.positions(0);
    for (const auto v : face.vertices) {
        const Vec3 rest = restOf(c).row(v).transpose();
        CHECK(Vec3(now.row(v).transpose()) == Vec3(linear * rest + shift));
        const Vec3 local = face.frame.toLocal(rest);
        const auto part = c.jointParameters(0).segment(response.firstColumn[2], response.bases[2].columns());
        const Vec3 said = c.frame(0) * Vec3(rest + face.frame.axes * (response.bases[2].at(local) * part));
        CHECK((said - (linear * rest + shift)).norm() < 1e-14);
    }
    CHECK(c.shownHandle(2).held);
    CHECK((c.shownHandle(2).at - pose.at).norm() < 1e-15);
    // Those that were not moved stay where they are.
    for (const int other : {0, 1, 3})
        for (const auto v : c.input().elements[0].faces[static_cast<std::size_t>(other)].vertices) CHECK(now.row(v) == restOf(c).row(v));
}

TEST_CASE("handles: thirty that are thrown about stay finite, and so do refused poses") {
    std::mt19937 random(2);
    Character c = built(ball(30));
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (int trial = 0; trial < 60; ++trial) {
        const double size = std::pow(10.0, 8.0 * d(random));
        for (int h = 0; h < 30; ++h) {
            const double x = d(random), y = d(random), z = d(random);
            REQUIRE(c.setHandle(h, {size * Vec3(x, y, z), randomTurn(random), true}));
        }
        c.update({}, 1.0 / 60.0);
        CHECK(finiteSurface(c));
    }
    const HandlePose before = c.handlePose(3);
    CHECK(!c.setHandle(3, {Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0), Eigen::Quaterniond::Identity(), true}));
    CHECK(!c.setHandle(3, {Vec3::Zero(), Eigen::Quaterniond(0, 0, 0, 0), true}));
    CHECK(!c.setHandle(3, {Vec3::Constant(1e200), Eigen::Quaterniond::Identity(), true}));
    CHECK(c.handlePose(3) == before);
    // All at one place, and turned against each other: no rotation is better than another.
    for (int h = 0; h < 30; ++h) REQUIRE(c.setHandle(h, {Vec3::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(h % 2 ? std::numbers::pi : 0.0, Vec3::UnitX())), true}));
    c.update({});
    CHECK(finiteSurface(c));
}

TEST_CASE("handles: the frame of the body follows a handle that is pulled across it without a jump") {
    Character c = built(ball(3));
    Eigen::Matrix3d last = c.frame(0).linear();
    const Vec3 from = originOf(c, 0);
    // Its rest is at most as fast as the handle: a hundredth of the way by a hundredth of a turn and a bit.
    for (int i = 1; i <= 400; ++i) {
        REQUIRE(c.setHandle(0, {from - 0.02 * i * from, Eigen::Quaterniond::Identity(), true}));
        c.update({});
        CHECK((c.frame(0).linear() - last).norm() < 0.05);
        last = c.frame(0).linear();
    }
}

TEST_CASE("handles: a frame allocates nothing") {
    Character c = built(ball(8));
    const Pose pose = restPose(c.input().skeleton);
    const auto before = allocations();
    for (int i = 0; i < 10; ++i) {
        c.setHandle(i % 8, {originOf(c, i % 8) * (1.0 + 0.05 * i), Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Vec3::UnitY())), true});
        c.update(pose, 1.0 / 60.0);
    }
    CHECK(allocations() == before);
}

TEST_CASE("handles: what a take kept of them is shown as it was, byte for byte") {
    Character c = built(ball(4));
    c.keepExact(true);
    c.setHandle(1, {originOf(c, 1) + Vec3(0.1, 0.4, 0), Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Vec3::UnitZ())), true});
    c.update({});
    std::vector<double> numbers(static_cast<std::size_t>(c.shapeLayout().size()));
    c.shape(numbers.data());
    const auto shown = c.surface(0);
    const std::vector<float> was(shown.positions, shown.positions + 3 * shown.vertices);
    c.setHandle(1, {originOf(c, 1), Eigen::Quaterniond::Identity(), false});
    c.update({});
    c.show(numbers.data());
    CHECK(std::memcmp(c.surface(0).positions, was.data(), was.size() * sizeof(float)) == 0);
}

TEST_CASE("handles: with bones in the body one moves with them until it is held; one that hangs on a bone's end moves with that") {
    CharacterInput input = ball(3);
    input.skeleton.points = {Vec3(0, 0, -0.5), Vec3(0, 0, 0.5), Vec3(0, 0, 1.5)};
    input.skeleton.bones = {{0, 1, -1, 1.0}, {1, 2, 0, 1.0}};
    input.elements[0].bones = {0};
    input.handles[1].bone = 1;
    Character c = built(std::move(input));
    Pose pose = restPose(c.input().skeleton);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
    for (auto& p : pose.points) p = turn * p + Vec3(1, 0, 0);
    for (auto& f : pose.frames) f = turn;
    const HandlePose held{originOf(c, 2) + Vec3(0, 0.2, 0), Eigen::Quaterniond::Identity(), true};
    REQUIRE(c.setHandle(2, held));
    c.update(pose);
    for (const int h : {0, 1}) {
        CHECK((c.shownHandle(h).at - (turn * originOf(c, h) + Vec3(1, 0, 0))).norm() < 1e-12);
        CHECK(c.shownHandle(h).rotation.angularDistance(turn) < 1e-12);
    }
    CHECK((c.shownHandle(2).at - held.at).norm() < 1e-14);
    // The second bone alone, about the end at which it starts.
    pose = restPose(c.input().skeleton);
    pose.frames[1] = turn;
    pose.points[2] = pose.points[1] + turn * Vec3(0, 0, 1);
    c.update(pose);
    CHECK((c.shownHandle(1).at - (pose.points[2] + turn * (originOf(c, 1) - Vec3(0, 0, 1.5)))).norm() < 1e-12);
    CHECK((c.shownHandle(0).at - originOf(c, 0)).norm() < 1e-12);
    // Where it lies is relative to what carries it.
    REQUIRE(c.setHandle(0, {originOf(c, 0) + Vec3(0.1, 0, 0), Eigen::Quaterniond::Identity(), false}));
    for (auto& p : pose.points) p += Vec3(0, 0, 5);
    c.update(pose);
    CHECK((c.shownHandle(0).at - (originOf(c, 0) + Vec3(0.1, 0, 5))).norm() < 1e-12);
}

TEST_CASE("handles: every effect works on a body that has nothing but handles, and stays finite") {
    for (int kind = 0; kind < 5; ++kind) {
        CAPTURE(kind);
        CharacterInput input = ball(3, kind == 0 ? BasisChoice(BasisKind::Modes, 5) : BasisChoice(BasisKind::Affine));
        if (kind == 0) input.effects.set(SmoothJointsEffect{});
        if (kind == 1) input.effects.set(JointDynamicsEffect{});
        if (kind == 2) input.effects.set(BendWarpEffect{});
        if (kind == 3) input.effects.set(GravityEffect{});
        if (kind == 4) input.format = ResponseFormat::Int16;
        Character c = built(std::move(input));
        for (int i = 1; i <= 30; ++i) {
            c.setHandle(0, {originOf(c, 0) + Vec3(0, 0, 0.02 * i), Eigen::Quaterniond(Eigen::AngleAxisd(0.05 * i, Vec3::UnitY())), true});
            c.update({}, 1.0 / 60.0);
            CHECK(finiteSurface(c));
        }
    }
}

TEST_CASE("handles: input that contradicts itself is refused") {
    CharacterInput input = ball(2);
    input.handles[1].joint = 0;
    CHECK(Character::build(input).error().code == "bad-value");
    input.handles[1] = {7};
    CHECK(Character::build(input).error().code == "bad-value");
    input.handles[1] = {1, 0};
    CHECK(Character::build(input).error().code == "bad-value");  // no such bone
}
