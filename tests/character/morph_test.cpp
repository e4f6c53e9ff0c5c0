// SPDX-License-Identifier: GPL-3.0-or-later
// Morph targets of render meshes in frames.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "core/character/character.h"
#include "tests/character/embedded.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

/// Two elements under a tube that a target blows up around the joint, and another one shifts at one end; the second has a weight at rest.
CharacterInput blownTube() {
    caterpillar::Shape shape;
    shape.elements = 2;
    shape.around = {16};
    shape.along = {6};
    shape.tips = shape.mirrored = true;
    CharacterInput input = caterpillar::make(shape);
    embedded::addRenderMesh(input, embedded::tube(0.55, 0.05, 1.95, 32, 40), 1.0);
    auto mesh = std::make_shared<EmbeddedMesh>(*input.renderMeshes[0]);
    auto model = std::make_shared<RenderModel>();
    const auto made = Character::build(input).value();
    const Points& rest = made.renderRestPositions(0);
    MorphTarget blow{"blow", 0.0, {}, {}}, shift{"shift", 0.5, {}, {}};
    std::vector<Eigen::RowVector3f> blown, shifted;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
        const Eigen::RowVector3d p = rest.row(v);
        if (const double part = 1.0 - 4.0 * std::abs(p.z() - 1.0); part > 0.0) {
            blow.vertices.push_back(static_cast<std::int32_t>(v));
            blown.push_back((0.4 * part * Eigen::RowVector3d(p.x(), p.y(), 0.0)).cast<float>());
        }
        if (p.z() > 1.7) {
            shift.vertices.push_back(static_cast<std::int32_t>(v));
            shifted.emplace_back(0.0f, 0.1f, 0.0f);
        }
    }
    const auto rows = [](MorphTarget& to, const std::vector<Eigen::RowVector3f>& from) {
        to.deltas.resize(static_cast<Eigen::Index>(from.size()), 3);
        for (std::size_t i = 0; i < from.size(); ++i) to.deltas.row(static_cast<Eigen::Index>(i)) = from[i];
    };
    rows(blow, blown);
    rows(shift, shifted);
    model->morphs = {blow, shift};
    mesh->model = std::move(model);
    input.renderMeshes[0] = std::move(mesh);
    return input;
}

Points shownFloats(const Character& c) {
    const auto surface = c.renderSurface(0);
    return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(surface.positions, surface.vertices, 3).cast<double>();
}

}  // namespace

TEST_CASE("morph targets: at rest they add their deltas, moved rigidly they move along, and without weights not a byte changes") {
    const CharacterInput input = blownTube();
    auto c = Character::build(input).value(), plain = Character::build(input).value();
    const auto& morphs = input.renderMeshes[0]->model->morphs;
    const Pose rest = restPose(input.skeleton);
    CHECK(c.morphWeights(0) == std::vector<double>{0.0, 0.5});
    CHECK(c.setMorph(0, 0, 0.75));
    CHECK(c.setMorph(0, 1, 1.5));
    CHECK_FALSE(c.setMorph(0, 1, 1.5));
    CHECK_FALSE(c.setMorph(0, 0, std::nan("")));
    Points goal = c.renderRestPositions(0);
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t i = 0; i < morphs[t].vertices.size(); ++i) goal.row(morphs[t].vertices[i]) += (t == 0 ? 0.75 : 1.0) * morphs[t].deltas.row(static_cast<Eigen::Index>(i)).cast<double>();
    c.update(rest);
    CHECK((c.renderPositions(0) - goal).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((shownFloats(c) - goal).cwiseAbs().maxCoeff() < 2e-6);
    // Rigidly with everything.
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()));
    Pose moved = rest;
    for (auto& p : moved.points) p = turn * p + Vec3(1, -2, 0.5);
    for (auto& q : moved.frames) q = turn * q;
    c.update(moved);
    const Points there = (goal * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(1, -2, 0.5);
    CHECK((c.renderPositions(0) - there).cwiseAbs().maxCoeff() < 2e-6);
    // And back: other frames have left nothing behind.
    (void)c.setMorph(0, 0, 0.0);
    (void)c.setMorph(0, 1, 0.5);
    const Pose bent = embedded::chainPose(input.skeleton, 0.6, 0.2, 1.1);
    c.update(bent);
    plain.update(bent);
    CHECK(std::memcmp(c.renderSurface(0).positions, plain.renderSurface(0).positions, 3 * sizeof(float) * static_cast<std::size_t>(plain.renderSurface(0).vertices)) == 0);
    CHECK(std::memcmp(c.renderSurface(0).normals, plain.renderSurface(0).normals, 3 * sizeof(float) * static_cast<std::size_t>(plain.renderSurface(0).vertices)) == 0);
}

TEST_CASE("morph targets: over a bent joint the body carries what they add, and neighbours stay neighbours") {
    const CharacterInput input = blownTube();
    auto c = Character::build(input).value();
    const auto& triangles = input.renderMeshes[0]->triangles;
    const Pose bent = embedded::chainPose(input.skeleton, 0.5, 0.3, 1.0);
    const auto longestEdge = [&](const Points& p) {
        double most = 0.0;
        for (Eigen::Index t = 0; t < triangles.rows(); ++t)
            for (int k = 0; k < 3; ++k) most = std::max(most, (p.row(triangles(t, k)) - p.row(triangles(t, (k + 1) % 3))).norm());
        return most;
    };
    c.update(bent);
    const Points before = c.renderPositions(0);
    const std::vector<float> normals(c.renderSurface(0).normals, c.renderSurface(0).normals + 3 * before.rows());
    (void)c.setMorph(0, 0, 1.0);
    c.update(bent);
    const Points after = c.renderPositions(0);
    CHECK((shownFloats(c) - after).cwiseAbs().maxCoeff() < 1e-5);
    // It goes outward everywhere, about as far as at rest: the surface stretches and shrinks by less than half.
    const auto& blow = input.renderMeshes[0]->model->morphs[0];
    for (std::size_t i = 0; i < blow.vertices.size(); ++i) {
        const Vec3 added = (after.row(blow.vertices[i]) - before.row(blow.vertices[i])).transpose();
        const double size = static_cast<double>(blow.deltas.row(static_cast<Eigen::Index>(i)).norm());
        CHECK(added.norm() < 1.5 * size);
        CHECK(added.norm() > 0.6 * size);
        CHECK(Eigen::Map<const Eigen::Vector3f>(normals.data() + 3 * blow.vertices[i]).cast<double>().dot(added) > 0.5 * size);
    }
    // The tube grows by at most 1.4 around, and nothing tears.
    CHECK(longestEdge(after) < 1.6 * longestEdge(before));
}

TEST_CASE("morph targets: shapes keep their weights, and a frame allocates nothing") {
    const CharacterInput input = blownTube();
    auto c = Character::build(input).value();
    const Pose bent = embedded::chainPose(input.skeleton, 0.5, 0.1, 1.05), other = embedded::chainPose(input.skeleton, 0.1, 0.0, 1.0);
    CHECK(c.shapeLayout().morphs == 2);
    (void)c.setMorph(0, 0, 0.8);
    c.keepExact(true);
    c.update(bent);
    std::vector<double> shape(static_cast<std::size_t>(c.shapeLayout().size()));
    c.shape(shape.data());
    const Points seen = shownFloats(c);
    const auto before = allocations();
    for (int i = 0; i < 5; ++i) {
        (void)c.setMorph(0, 0, 0.1 * i);
        c.update(i % 2 ? bent : other);
    }
    CHECK(allocations() == before);
    c.show(shape.data());
    CHECK(shownFloats(c) == seen);
    CHECK(c.morphWeights(0)[0] == 0.8);
}
