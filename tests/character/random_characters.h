// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "core/effects/bend_warp_job.h"
#include "core/effects/body_loads_job.h"
#include "core/effects/contact_job.h"
#include "core/effects/ground_job.h"
#include "core/effects/joint_dynamics_job.h"
#include "core/effects/smooth_joints_job.h"
#include "core/effects/touch_job.h"
#include "tests/character/caterpillar.h"
#include "tests/character/embedded.h"

/// Caterpillars of any kind: number and size of elements, bases, formats, effects, rims that do not match.
namespace imomushi {

inline CharacterInput randomCharacter(std::mt19937& random) {
    const auto number = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    caterpillar::Shape shape;
    shape.elements = number(2, 4);
    const double size = std::pow(10.0, number(-2, 2));
    shape.radius = 0.5 * size, shape.length = size;
    shape.around = {number(5, 9), number(5, 9)};
    if (chance(0.5)) shape.around = {number(5, 12)};
    shape.along = {number(2, 4), number(2, 4)};
    shape.tips = chance(0.5);
    shape.mirrored = chance(0.3);
    shape.dome = chance(0.3) ? 0.2 / size : 0.0;
    shape.precomputed = false;
    constexpr BasisChoice kBases[] = {BasisKind::Paper, BasisKind::Affine, BasisKind::Full, {BasisKind::Modes, 5}, {BasisKind::Modes, 12}};
    shape.basis = kBases[number(0, 4)];
    CharacterInput input = caterpillar::make(shape);
    input.format = static_cast<ResponseFormat>(number(0, 2));
    if (chance(0.4) && shape.basis != BasisKind::Full) input.effects.set(SmoothJointsEffect{});
    if (chance(0.4)) input.effects.set(GravityEffect{});
    if (chance(0.4)) input.effects.set(InflateEffect{});
    if (chance(0.3)) input.effects.set(JointDynamicsEffect{});
    if (chance(0.4)) input.effects.set(TouchEffect{});
    if (chance(0.3)) input.effects.set(ContactEffect{});
    if (chance(0.3)) input.effects.set(GroundEffect{});
    BendWarpEffect warp;
    warp.elements.assign(input.elements.size(), 0);
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        if (chance(0.15)) continue;  // not precomputed: follows its bones rigidly
        auto& element = input.elements[e];
        warp.elements[e] = chance(0.15);
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.basis = input.basis;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        in.loads = input.effects.has<GravityEffect>() || input.effects.has<InflateEffect>() ? BodyLoads::Always : BodyLoads::None;
        in.touch = input.effects.has<TouchEffect>() || input.effects.has<ContactEffect>() ? 6 : 0;
        auto made = buildResponse(in, {});
        REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
        element.response = std::make_shared<const ElementResponse>(std::move(*made));
    }
    warp.automatic = chance(0.5);
    input.effects.set(std::move(warp));
    return input;
}

/// Adds a render mesh over it, some of whose vertices are at those of a body, others an attached part, with a morph target.
inline void addRandomRenderMesh(CharacterInput& input, std::mt19937& random) {
    const auto number = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const auto& joints = input.skeleton.points;
    const double length = (joints.back() - joints.front()).norm() / static_cast<double>(input.elements.size());
    const double end = length * static_cast<double>(input.elements.size());
    TriangleMesh mesh = embedded::tube(length * std::uniform_real_distribution<double>(0.45, 0.6)(random), 0.02 * end, 0.98 * end, number(5, 24), number(8, 30));
    const Points& body = input.elements[0].mesh->body.vertices;
    const Eigen::Index count = std::min<Eigen::Index>(5, mesh.vertices.rows());
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Index v = number(0, static_cast<int>(body.rows()) - 1);
        if (body(v, 2) < length) mesh.vertices.row(i) = body.row(v);
    }
    embedded::addRenderMesh(input, mesh, length);
    auto points = std::make_shared<EmbeddedPoints>(*input.elements[0].embedded);
    EmbeddedPoints::Attached part{Vec3(0.5 * length, 0.0, 0.5 * length), {}};
    for (std::int32_t i = static_cast<std::int32_t>(points->rest.rows()) - 1; i >= 0 && part.points.size() < 9; --i)
        if (points->bodyVertex[static_cast<std::size_t>(i)] < 0) part.points.push_back(i);
    points->attached.push_back(std::move(part));
    input.elements[0].embedded = std::move(points);
    auto withMorph = std::make_shared<EmbeddedMesh>(*input.renderMeshes[0]);
    auto model = std::make_shared<RenderModel>();
    MorphTarget target{"blow", 0.0, {0, 3, 4}, Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>::Constant(3, 3, static_cast<float>(0.1 * length))};
    model->morphs.push_back(std::move(target));
    withMorph->model = std::move(model);
    input.renderMeshes[0] = std::move(withMorph);
}

/// A pose on the way from `pose` towards a random place of the last joint point, the first one held.
inline void wander(Character& character, std::mt19937& random, Pose& pose) {
    const auto& rest = character.input().skeleton.points;
    const double length = (rest.back() - rest.front()).norm();
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    const Vec3 target = rest.front() + length * Vec3(0.6 * d(random), 0.6 * d(random), 0.9 + 0.4 * d(random));
    for (int i = 0; i < 4; ++i) character.solvePose({{0, rest.front()}, {static_cast<int>(rest.size()) - 1, target}}, pose);
}

}  // namespace imomushi
