// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that somebody else deforms, without who does it (tests/render has that).
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "core/character/deform_input.h"
#include "core/effects/touch_job.h"
#include "tests/character/random_characters.h"
#include "tests/support/allocations.h"

using namespace imomushi;

TEST_CASE("external deformation: whoever asks for a surface gets the bytes of a character that makes all of them, in any order of asking and switching") {
    std::mt19937 random(5);
    for (int kind = 0; kind < 24; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        if (kind % 2 == 1) addRandomRenderMesh(input, random);
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
                for (Character* c : {&here, &there}) (void)setFinger(*c, 0, 0, at, 0.8 * at, 0.0);
            }
            if (input.effects.has<TouchEffect>() && rarely(random))
                for (Character* c : {&here, &there}) liftFinger(*c, 0, 0);
            if (!input.renderMeshes.empty()) {
                const Eigen::Quaterniond turn(Eigen::AngleAxisd(coin(random) ? 0.5 : 0.0, Vec3::UnitX()));
                const double weight = rarely(random) ? 0.7 : 0.0;
                for (Character* c : {&here, &there}) (void)(c->setTurn(0, 0, turn), c->setMorph(0, 0, weight));
            }
            here.update(pose, 1.0 / 60.0);
            there.update(pose, 1.0 / 60.0);
            if (!input.renderMeshes.empty() && coin(random)) {
                const auto a = here.renderSurface(0), b = there.renderSurface(0);
                CHECK(std::equal(a.positions, a.positions + 3 * a.vertices, b.positions));
                CHECK(std::equal(a.normals, a.normals + 3 * a.vertices, b.normals));
                CHECK(here.renderPositions(0) == there.renderPositions(0));
            }
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

TEST_CASE("external deformation: under a render mesh a frame evaluates nothing but the frames of attached parts, and its surface is there for who asks") {
    CharacterInput input = caterpillar::make({});
    std::mt19937 random(2);
    addRandomRenderMesh(input, random);
    auto c = Character::build(input).value(), here = Character::build(input).value();
    const DeformInput& deformInput = c.deformInput();
    const auto& mesh = deformInput.meshes.at(0);
    for (int e = 0; e < 5; ++e) CHECK(c.deformExternally(e, true));
    CHECK_FALSE(deformInput.external(mesh));
    Pose pose = restPose(c.input().skeleton);
    for (int frame = 0; frame < 5; ++frame) {
        for (int i = 0; i < 5; ++i) c.solvePose({{0, Vec3::Zero()}, {5, Vec3(0.1 * (frame + 1), 0, 5)}}, pose);
        const auto asked = allocations();
        c.update(pose);
        CHECK(allocations() == asked);
        CHECK(c.stats().evaluatedVertices == 0);
        CHECK(deformInput.external(mesh));
    }
    const auto revision = c.renderSurface(0).revision;
    here.update(pose);
    CHECK(std::equal(c.renderSurface(0).positions, c.renderSurface(0).positions + 3 * mesh.vertices.size(), here.renderSurface(0).positions));
    c.update(pose);
    CHECK(c.renderSurface(0).revision == revision);
    // A morph target is added to the finished surface, which is made here.
    CHECK(c.setMorph(0, 0, 1.0));
    c.update(pose);
    CHECK_FALSE(deformInput.external(mesh));
    CHECK(c.renderSurface(0).revision != revision);
    CHECK(c.setMorph(0, 0, 0.0));
    c.update(pose);
    CHECK(deformInput.external(mesh));
    CHECK(std::equal(c.renderSurface(0).positions, c.renderSurface(0).positions + 3 * mesh.vertices.size(), here.renderSurface(0).positions));
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
    REQUIRE(setFinger(c, 2, 0, Vec3(0.5, 0, 2.5), Vec3(0.4, 0, 2.5), 0.0));
    for (int frame = 0; frame < 3; ++frame) c.update(pose, 1.0 / 60.0);
    CHECK_FALSE(deformInput.elements[2].external);
    CHECK(deformInput.elements[3].external);
    liftFinger(c, 2, 0);
    for (int frame = 0; frame < 600 && !c.resting(); ++frame) c.update(pose, 1.0 / 60.0);
    c.update(pose, 1.0 / 60.0);
    CHECK(deformInput.elements[2].external);
}
