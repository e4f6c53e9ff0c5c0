// SPDX-License-Identifier: GPL-3.0-or-later
// What characters share, and the jobs of effects by themselves.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/character/element_runtime.h"
#include "tests/character/random_characters.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

ElementRuntime::Input inputOf(const CharacterInput& input, std::size_t e) {
    const auto& element = input.elements[e];
    return {element.mesh, element.faces, element.response, std::vector<char>(element.faces.size(), 1), input.format, {}, element.nu};
}

bool sameSurfaces(const Character& a, const Character& b) {
    for (int e = 0; e < static_cast<int>(a.input().elements.size()); ++e) {
        const auto s = a.surface(e), t = b.surface(e);
        if (!std::equal(s.positions, s.positions + 3 * s.vertices, t.positions) || !std::equal(s.normals, s.normals + 3 * s.vertices, t.normals)) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("runtime: it is found again by what it was built from, and by nothing else") {
    const CharacterInput input = caterpillar::make({});
    ElementRuntimes known;
    const auto made = ElementRuntime::build(inputOf(input, 1), {}).value();
    known.add(made);
    CHECK(known.find(inputOf(input, 1)) == made);
    CHECK(known.find(inputOf(input, 2)) == nullptr);
    auto other = inputOf(input, 1);
    other.nu = 0.3;  // says nothing without the warp
    CHECK(known.find(other) == made);
    other.tables.warp = true;
    CHECK(known.find(other) == nullptr);
    other = inputOf(input, 1);
    other.format = ResponseFormat::Half;
    CHECK(known.find(other) == nullptr);
    other = inputOf(input, 1);
    other.covered[0] = 0;
    CHECK(known.find(other) == nullptr);
    other = inputOf(input, 1);
    other.response = std::make_shared<const ElementResponse>(*input.elements[1].response);
    CHECK(known.find(other) == nullptr);
    CHECK_FALSE(known.knows(other.mesh, other.faces, other.response));
    other = inputOf(input, 1);
    std::swap(other.faces[0], other.faces[1]);
    CHECK(known.find(other) == nullptr);
    CHECK(known.knows(input.elements[1].mesh, input.elements[1].faces, input.elements[1].response));
}

TEST_CASE("runtime: what checks a pose is made once, whatever effects come and go") {
    const CharacterInput input = caterpillar::make({});
    auto character = Character::build(input).value();
    const auto missing = character.missingWatches();
    CHECK(missing.size() == input.elements.size());
    missing.front()();
    CHECK(character.missingWatches().size() == missing.size() - 1);
    (void)character.measurePose();
    CHECK(character.missingWatches().empty());
    CharacterInput warped = input;
    warped.effects.set(BendWarpEffect{});
    const auto next = Character::build(warped, {&character}).value();
    CHECK(next.missingWatches().empty());
    warped.elements[1].response = std::make_shared<const ElementResponse>(*input.elements[1].response);
    CHECK(Character::build(warped, {&character}).value().missingWatches().size() == 1);
}

TEST_CASE("runtime: other embedded points change nothing of the body, whose tables are taken over") {
    const CharacterInput input = caterpillar::make({});
    ElementRuntimes known;
    auto with = [&](double x, bool attached) {
        auto of = inputOf(input, 1);
        auto points = std::make_shared<EmbeddedPoints>();
        points->rest = Points::Constant(4, 3, x);
        if (attached) points->attached.push_back({Vec3::Constant(x), {0, 2}});
        of.embedded = points;
        of.tables.warp = true;
        return of;
    };
    const auto made = ElementRuntime::build(with(0.5, false), {}).value();
    known.add(made);
    const auto other = with(0.5, true);
    CHECK(known.find(other) == nullptr);
    const auto like = known.findLike(other);
    REQUIRE(like == made);
    const auto taken = ElementRuntime::build(other, known).value(), fresh = ElementRuntime::build(other, {}).value();
    REQUIRE(made->warp);
    CHECK(taken->warp == made->warp);
    CHECK(fresh->warp != made->warp);
    CHECK(taken->bodyBlocks == fresh->bodyBlocks);
    CHECK(taken->embedded->parts == 1);
    auto softer = with(0.5, true);
    softer.format = ResponseFormat::Half;
    CHECK(known.findLike(softer) == nullptr);
    auto none = inputOf(input, 1);
    none.tables.warp = true;
    CHECK(known.findLike(none) == nullptr);
}

TEST_CASE("runtime: a character that takes over another's shows the bytes of one that is built anew") {
    std::mt19937 random(3);
    for (int kind = 0; kind < 12; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        auto first = Character::build(input).value();
        Pose pose = restPose(input.skeleton);
        wander(first, random, pose);
        for (int i = 0; i < 3; ++i) first.update(pose, 1.0 / 60.0);
        // An edit: one element is softer, another is no longer precomputed.
        input.elements[0].stiffness *= 0.5;
        if (kind % 2 == 0) input.elements[1].response = nullptr;
        auto taken = Character::build(input, {&first}).value(), fresh = Character::build(input).value();
        for (int i = 0; i < 3; ++i) {
            CHECK(sameSurfaces(taken, fresh));
            taken.update(pose, 1.0 / 60.0);
            fresh.update(pose, 1.0 / 60.0);
        }
        CHECK(sameSurfaces(taken, fresh));
    }
}

TEST_CASE("runtime: an edit of one element of 200 costs a small part of a build") {
    caterpillar::Shape shape;
    shape.elements = 200;
    shape.around = {16};
    shape.along = {8};
    shape.precomputed = false;
    CharacterInput input = caterpillar::make(shape);
    // One response serves all: their meshes differ in place alone, and how they move is no matter here.
    for (const std::size_t e : {0u, 1u, 199u}) {
        ResponseInput in;
        in.mesh = input.elements[e].mesh;
        in.faces = input.elements[e].faces;
        in.basis = input.basis;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        input.elements[e].response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
    for (std::size_t e = 2; e < 199; ++e) input.elements[e].response = input.elements[1].response;
    const auto asked = [&](const Character* previous) {
        const std::size_t before = allocations();
        (void)Character::build(input, {previous}).value();
        return allocations() - before;
    };
    const auto first = Character::build(input).value();
    const std::size_t whole = asked(nullptr), none = asked(&first);
    input.elements[100].response = std::make_shared<const ElementResponse>(*input.elements[100].response);
    const std::size_t one = asked(&first);
    MESSAGE("a build of 200 elements asks for memory " << whole << " times, after an edit of one of them " << one << " times, after none " << none << " times");
    // All elements are made of as much: one is a 200th of what is not taken over.
    REQUIRE(whole > none);
    CHECK(one - none <= (whole - none) / 100);
}

TEST_CASE("effects: numbers that are none are refused, and say which rule they break") {
    const auto refused = [](auto effect) {
        CharacterInput input = caterpillar::make({});
        input.effects.set(std::move(effect));
        const auto made = Character::build(std::move(input));
        return !made && made.error().code == "bad-value";
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    GravityEffect gravity;
    gravity.shearModulus = -1.0;
    CHECK(refused(gravity));
    gravity = {};
    gravity.acceleration.y() = nan;
    CHECK(refused(gravity));
    InflateEffect inflate;
    inflate.pressure = nan;
    CHECK(refused(inflate));
    CHECK(refused(JointDynamicsEffect(nan, 0.2)));
    TouchEffect touch;
    touch.friction = -1.0;
    CHECK(refused(touch));
}

TEST_CASE("effects: a row of statistics for each that the character has, and none for others") {
    CharacterInput input = caterpillar::make({});
    input.effects.set(SmoothJointsEffect{});
    input.effects.set(JointDynamicsEffect{});
    auto c = Character::build(std::move(input)).value();
    c.update(restPose(c.input().skeleton), 1.0 / 60.0);
    REQUIRE(c.stats().effects.size() == 2);
    CHECK(c.stats().effectMs(SmoothJointsEffect::kName) > 0.0);
    CHECK(c.stats().effectMs(JointDynamicsEffect::kName) > 0.0);
    CHECK(c.stats().effectMs(GravityEffect::kName) == 0.0);
}
