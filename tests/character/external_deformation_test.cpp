// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that somebody else deforms, without who does it (tests/render has that).
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/character/deform_input.h"
#include "tests/character/random_characters.h"
#include "tests/support/allocations.h"

using namespace imomushi;

TEST_CASE("external deformation: whoever asks for a surface gets the bytes of a character that makes all of them, in any order of asking and switching") {
    std::mt19937 random(5);
    for (int kind = 0; kind < 12; ++kind) {
        CAPTURE(kind);
        const CharacterInput input = randomCharacter(random);
        auto here = Character::build(input).value(), there = Character::build(input).value();
        const auto elements = static_cast<int>(input.elements.size());
        (void)there.deformInput();
        Pose pose = restPose(input.skeleton);
        std::bernoulli_distribution coin(0.5), rarely(0.2);
        for (int frame = 0; frame < 20; ++frame) {
            for (int e = 0; e < elements; ++e)
                if (rarely(random)) (void)there.deformExternally(e, coin(random));
            if (coin(random)) wander(here, random, pose);
            if (input.effects.has<TouchEffect>() && rarely(random)) {
                const Vec3 at = input.elements[0].mesh->body.vertices.row(0).transpose();
                for (Character* c : {&here, &there}) (void)c->setFinger(0, 0, at, 0.8 * at, 0.0);
            }
            if (input.effects.has<TouchEffect>() && rarely(random))
                for (Character* c : {&here, &there}) c->liftFinger(0, 0);
            here.update(pose, 1.0 / 60.0);
            there.update(pose, 1.0 / 60.0);
            for (int e = 0; e < elements; ++e) {
                if (coin(random)) continue;
                const auto a = here.surface(e), b = there.surface(e);
                CHECK(std::equal(a.positions, a.positions + 3 * a.vertices, b.positions));
                CHECK(std::equal(a.normals, a.normals + 3 * a.vertices, b.normals));
                CHECK(there.deformInput().elements[static_cast<std::size_t>(e)].positions == b.positions);
            }
        }
    }
}

TEST_CASE("external deformation: a frame evaluates no vertex of such elements, nor allocates, and what moved or not is told by revisions") {
    auto c = Character::build(caterpillar::make({})).value();
    const DeformInput& deformInput = c.deformInput();
    for (int e = 0; e < 5; ++e) CHECK(c.deformExternally(e, true));
    Pose pose = restPose(c.input().skeleton);
    c.update(pose);
    for (int frame = 0; frame < 5; ++frame) {
        for (int i = 0; i < 5; ++i) c.solvePose({{0, Vec3::Zero()}, {5, Vec3(0.1 * (frame + 1), 0, 5)}}, pose);
        std::vector<std::uint64_t> before;
        for (const auto& e : deformInput.elements) before.push_back(e.frame.revision);
        const auto asked = allocations();
        c.update(pose);
        CHECK(allocations() == asked);
        CHECK(c.stats().evaluatedElements == 0);
        CHECK(c.stats().evaluatedVertices == 0);
        for (std::size_t e = 0; e < 5; ++e) {
            CHECK(deformInput.elements[e].external);
            CHECK(deformInput.elements[e].frame.revision != before[e]);
            before[e] = deformInput.elements[e].frame.revision;
        }
        c.update(pose);
        for (std::size_t e = 0; e < 5; ++e) CHECK(deformInput.elements[e].frame.revision == before[e]);
    }
}

TEST_CASE("external deformation: elements under the bend warp are made here, and touched ones while a finger presses") {
    CharacterInput input = caterpillar::make({});
    BendWarpEffect warp;
    warp.elements = {0, 1, 0, 0, 0};
    input.effects.set(std::move(warp));
    TouchEffect touch;
    touch.elements = {0, 0, 1, 0, 0};
    input.effects.set(std::move(touch));
    ResponseInput in;
    in.mesh = input.elements[2].mesh;
    in.faces = input.elements[2].faces;
    in.basis = input.basis;
    in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
    in.touch = 6;
    input.elements[2].response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    auto c = Character::build(std::move(input)).value();
    const auto& deformInput = c.deformInput();
    CHECK_FALSE(deformInput.elements[1].possible);
    for (int e = 0; e < 5; ++e) CHECK(c.deformExternally(e, true) == (e != 1));
    const Pose pose = restPose(c.input().skeleton);
    c.update(pose, 1.0 / 60.0);
    CHECK_FALSE(deformInput.elements[1].external);
    CHECK(deformInput.elements[2].external);
    REQUIRE(c.setFinger(2, 0, Vec3(0.5, 0, 2.5), Vec3(0.4, 0, 2.5), 0.0));
    for (int frame = 0; frame < 3; ++frame) c.update(pose, 1.0 / 60.0);
    CHECK_FALSE(deformInput.elements[2].external);
    CHECK(deformInput.elements[3].external);
    c.liftFinger(2, 0);
    for (int frame = 0; frame < 600 && !c.resting(); ++frame) c.update(pose, 1.0 / 60.0);
    c.update(pose, 1.0 / 60.0);
    CHECK(deformInput.elements[2].external);
}
