// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a render mesh that keep their shape, and are turned.
#include <doctest/doctest.h>

#include <cstring>
#include <numbers>

#include "core/base/rotation_vector.h"
#include "core/effects/bend_warp_job.h"
#include "tests/character/embedded.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

const Vec3 kPivot(0.5, 0.0, 0.6);

/// Two cylinders of length 1 and radius .5, and an eye beside the first one; `more`: points of flesh beside it.
CharacterInput withEye(bool attached = true, bool more = false) {
    caterpillar::Shape shape;
    shape.elements = 2;
    shape.around = {16};
    shape.along = {6};
    shape.tips = shape.mirrored = true;
    CharacterInput input = caterpillar::make(shape);
    const auto eye = shapes::sphere(0.1, 1);
    const auto flesh = more ? embedded::tube(0.51, 0.1, 0.9, 12, 6) : TriangleMesh();
    const Eigen::Index own = eye.mesh.vertices.rows();
    auto points = std::make_shared<EmbeddedPoints>();
    points->rest.resize(own + flesh.vertices.rows(), 3);
    points->rest.topRows(own) = eye.mesh.vertices.rowwise() + Eigen::RowVector3d(0.55, 0.0, 0.6);
    points->rest.bottomRows(flesh.vertices.rows()) = flesh.vertices;
    auto mesh = std::make_shared<EmbeddedMesh>();
    mesh->triangles = eye.mesh.triangles;
    if (attached) points->attached.push_back({kPivot, {}});
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(points->rest.rows()); ++i) {
        if (attached && i < own) points->attached[0].points.push_back(i);
        mesh->vertices.push_back({0, i, false});
    }
    input.renderMeshes = {mesh};
    input.elements[0].embedded = points;
    return input;
}

std::vector<float> shownOf(const Character& c) {
    const auto s = c.renderSurface(0);
    std::vector<float> all(s.positions, s.positions + 3 * s.vertices);
    all.insert(all.end(), s.normals, s.normals + 3 * s.vertices);
    return all;
}

bool sameBytes(const std::vector<float>& a, const std::vector<float>& b) { return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0; }

Eigen::Quaterniond about(const Vec3& axis, double angle) { return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())); }

/// The rotation that takes a part at rest to where it is.
Eigen::Matrix3d rotationBetween(const Points& rest, const Points& now) {
    const Points a = rest.rowwise() - rest.colwise().mean(), b = now.rowwise() - now.colwise().mean();
    return (a.transpose() * a).ldlt().solve(a.transpose() * b).transpose();
}

}  // namespace

TEST_CASE("rotation vectors: the way there and back, whatever the angle and the sign of the quaternion") {
    for (const double angle : {0.0, 1e-9, 0.3, 1.5, 3.1}) {
        const Vec3 v = angle * Vec3(1, -2, 0.5).normalized();
        Eigen::Quaterniond q = rotationOf(v);
        CHECK((rotationVector(q) - v).norm() <= 1e-12 * (1.0 + angle));
        q.coeffs() *= -1.0;
        CHECK((rotationVector(q) - v).norm() <= 1e-12 * (1.0 + angle));
    }
    CHECK(rotationVector(Eigen::Quaterniond(-1, 0, 0, 0)) == Vec3::Zero());
}

TEST_CASE("attached parts: all distances stay to 1e-9 in every pose, turned or not, under the bend warp too") {
    for (const bool warped : {false, true}) {
        CAPTURE(warped);
        CharacterInput input = withEye();
        if (warped) input.effects.set(BendWarpEffect{});
        auto c = Character::build(input).value();
        const Points rest = input.elements[0].embedded->rest;
        for (const double turn : {0.0, 0.7})
            for (const double bend : {0.0, 0.5, 1.2})
                for (const double stretch : {0.7, 1.0, 1.6}) {
                    c.setTurn(0, 0, about({1, 1, 0.3}, turn));
                    c.update(embedded::chainPose(input.skeleton, bend, 0.4, stretch));
                    const Points now = c.renderPositions(0);
                    double worst = 0.0;
                    for (Eigen::Index a = 0; a < now.rows(); ++a)
                        for (Eigen::Index b = 0; b < a; ++b) {
                            const double was = (rest.row(a) - rest.row(b)).norm();
                            worst = std::max(worst, std::abs((now.row(a) - now.row(b)).norm() - was) / was);
                        }
                    CHECK(worst < 1e-9);
                    CHECK(rotationBetween(rest, now).determinant() > 0.5);
                }
    }
}

TEST_CASE("attached parts: at rest they are where they were, and a turn goes about the pivot while the body carries it on") {
    const CharacterInput input = withEye();
    auto c = Character::build(input).value();
    auto flesh = Character::build(withEye(false)).value();
    const Points rest = input.elements[0].embedded->rest;
    c.update({});
    CHECK((c.renderPositions(0) - rest).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((flesh.renderPositions(0) - rest).cwiseAbs().maxCoeff() < 1e-12);

    const Eigen::Quaterniond turn = about({0, 0, 1}, 0.6);
    CHECK(c.setTurn(0, 0, turn));
    CHECK(!c.setTurn(0, 0, turn));
    c.update({});
    const Points turned = ((turn.toRotationMatrix() * (rest.rowwise() - kPivot.transpose()).transpose()).transpose()).rowwise() + kPivot.transpose();
    CHECK((c.renderPositions(0) - turned).cwiseAbs().maxCoeff() < 1e-12);

    // The motion of the body comes on top: the same for the part turned and not.
    const Pose bent = embedded::chainPose(input.skeleton, 0.8, 0.3, 1.2);
    c.update(bent);
    const Points both = c.renderPositions(0);
    c.setTurn(0, 0, Eigen::Quaterniond::Identity());
    c.update(bent);
    const Points carried = c.renderPositions(0);
    const Eigen::Matrix3d body = rotationBetween(rest, carried);
    CHECK((rotationBetween(rest, both) - body * turn.toRotationMatrix()).cwiseAbs().maxCoeff() < 1e-9);
    const Vec3 pivot = carried.row(0).transpose() + body * (kPivot - rest.row(0).transpose());
    CHECK(((both.row(0).transpose() - pivot) - body * (turn * (rest.row(0).transpose() - kPivot))).norm() < 1e-9);
    // It follows the flesh beside it.
    flesh.update(bent);
    CHECK((flesh.renderPositions(0) - carried).rowwise().norm().maxCoeff() < 0.1);

    // No rotation is refused.
    CHECK(!c.setTurn(0, 0, Eigen::Quaterniond(2, 0, 0, 0)));
    CHECK(!c.setTurn(0, 0, Eigen::Quaterniond(0, 0, 0, 0)));
    CHECK(!c.setTurn(0, 0, Eigen::Quaterniond(std::nan(""), 0, 0, 1)));
    c.update(bent);
    CHECK((c.renderPositions(0) - carried).cwiseAbs().maxCoeff() == 0.0);
}

TEST_CASE("attached parts: they turn as smoothly as the body does") {
    CharacterInput input = withEye();
    auto c = Character::build(input).value();
    const Points rest = input.elements[0].embedded->rest;
    constexpr int kSteps = 300;
    Eigen::Matrix3d last = Eigen::Matrix3d::Identity(), lastStep = Eigen::Matrix3d::Zero();
    Vec3 at = rest.colwise().mean().transpose(), lastMove = Vec3::Zero();
    for (int i = 0; i <= kSteps; ++i) {
        const double part = static_cast<double>(i) / kSteps;
        c.update(embedded::chainPose(input.skeleton, 1.5 * part, 1.0 * part, 1.0 + 0.5 * part));
        const Points now = c.renderPositions(0);
        const Eigen::Matrix3d turn = rotationBetween(rest, now);
        const Vec3 middle = now.colwise().mean().transpose();
        // A step goes on as the one before: to the second order in 1/kSteps, with room for the strongest curvature of this motion.
        const double second = 50.0 / (kSteps * kSteps);
        if (i > 1) {
            CHECK((turn - last - lastStep).cwiseAbs().maxCoeff() < second);
            CHECK((middle - at - lastMove).norm() < second);
        }
        lastStep = turn - last;
        lastMove = middle - at;
        last = turn;
        at = middle;
    }
}

TEST_CASE("attached parts: turning allocates nothing, a turn that is there changes no byte, and none is what was before") {
    CharacterInput input = withEye(true, true);
    auto c = Character::build(input).value();
    auto other = Character::build(input).value();
    const Pose pose = embedded::chainPose(input.skeleton, 0.5, 0.2, 1.1);
    for (Character* each : {&c, &other}) each->update(pose);
    const auto before = allocations();
    for (int i = 1; i <= 20; ++i) {
        c.setTurn(0, 0, about({0, 1, 0.5}, 0.05 * i));
        c.update(pose, 1.0 / 60.0);
    }
    CHECK(allocations() == before);
    const auto turned = shownOf(c);
    CHECK(!sameBytes(turned, shownOf(other)));
    const auto revision = c.renderSurface(0).revision;
    c.update(pose);
    CHECK(c.renderSurface(0).revision == revision);
    CHECK(sameBytes(shownOf(c), turned));
    c.setTurn(0, 0, Eigen::Quaterniond::Identity());
    c.update(pose);
    CHECK(c.renderSurface(0).revision != revision);
    CHECK(sameBytes(shownOf(c), shownOf(other)));
}

TEST_CASE("attached parts: a take shows turns byte for byte, between two shapes they turn evenly, and the next update is the character's own") {
    CharacterInput input = withEye();
    auto c = Character::build(input).value();
    c.keepExact(true);
    const auto size = static_cast<std::size_t>(c.shapeLayout().size());
    CHECK(c.shapeLayout().turns == 1);
    CHECK(Character::build(withEye(false)).value().shapeLayout().turns == 0);
    const Pose pose = embedded::chainPose(input.skeleton, 0.5, 0.2, 1.1);
    std::vector<double> first(size), second(size), mean(size);
    c.update(pose);
    const auto plain = shownOf(c);
    c.shape(first.data());
    c.setTurn(0, 0, about({0, 0, 1}, 1.0));
    c.update(pose);
    c.shape(second.data());
    const auto turned = shownOf(c);
    c.setTurn(0, 0, Eigen::Quaterniond::Identity());
    c.update({});
    c.show(second.data());
    CHECK(sameBytes(shownOf(c), turned));
    c.show(first.data());
    CHECK(sameBytes(shownOf(c), plain));
    c.between(first.data(), second.data(), 0.25, mean.data());
    c.show(mean.data());
    const Eigen::Matrix3d half = rotationBetween(input.elements[0].embedded->rest, c.renderPositions(0));
    c.show(first.data());
    const Eigen::Matrix3d body = rotationBetween(input.elements[0].embedded->rest, c.renderPositions(0));
    CHECK((body.transpose() * half - about({0, 0, 1}, 0.25).toRotationMatrix()).cwiseAbs().maxCoeff() < 1e-9);
    c.show(second.data());
    c.update(pose);
    CHECK(sameBytes(shownOf(c), plain));
}

TEST_CASE("attached parts: attaching one builds the embedding of its element anew, and nothing else") {
    CharacterInput input = withEye(false, true);
    input.effects.set(BendWarpEffect{});
    auto flesh = Character::build(input).value();
    CharacterInput rigid = withEye(true, true);
    rigid.effects = input.effects;
    for (std::size_t e = 0; e < 2; ++e) {  // as a document does: the same objects
        rigid.elements[e].mesh = input.elements[e].mesh;
        rigid.elements[e].response = input.elements[e].response;
    }
    auto taken = Character::build(rigid, {&flesh}).value();
    auto fresh = Character::build(rigid).value();
    const Pose pose = embedded::chainPose(input.skeleton, 0.9, 0.3, 1.2);
    for (Character* each : {&taken, &fresh}) {
        each->setTurn(0, 0, about({1, 0, 0}, 0.4));
        each->update(pose);
    }
    CHECK(sameBytes(shownOf(taken), shownOf(fresh)));
    CHECK((taken.positions(0) - fresh.positions(0)).cwiseAbs().maxCoeff() == 0.0);
}
