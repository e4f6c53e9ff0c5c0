// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>

#include "core/character/character.h"
#include "core/character/joint_equilibrium.h"
#include "tests/character/caterpillar.h"
#include "tests/character/full_joints.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

CharacterInput chain(const BasisChoice& basis, bool tips = true) {
    caterpillar::Shape shape;
    shape.elements = 4;
    shape.tips = tips;
    shape.basis = basis;
    CharacterInput input = caterpillar::make(shape);
    input.smoothJoints = true;
    return input;
}

double gap(const Character& c) {
    double worst = 0;
    for (const auto& joint : c.input().joints)
        for (const auto& [v, w] : joint.welded) {
            const auto a = c.surface(joint.faces[0].element), b = c.surface(joint.faces[1].element);
            for (int i = 0; i < 3; ++i) worst = std::max(worst, std::abs(double(a.positions[3 * v + i]) - double(b.positions[3 * w + i])));
            worst = std::max(worst, (c.positions(joint.faces[0].element).row(v) - c.positions(joint.faces[1].element).row(w)).norm());
        }
    return worst;
}

}  // namespace

TEST_CASE("smooth joints: at rest nothing moves, and every basis closes its seams in every pose, however many modes") {
    for (const char* name : {"paper", "affine", "modes:1", "modes:5", "modes:12", "modes:36", "full"}) {
        CAPTURE(name);
        auto c = Character::build(chain(parseBasis(name).value())).value();
        for (int e = 0; e < 4; ++e) CHECK((c.positions(e) - c.input().elements[e].mesh->body.vertices).cwiseAbs().maxCoeff() < 1e-9);
        for (const auto& pose : full_joints::standardPoses(4, Vec3::UnitZ())) {
            c.update(full_joints::poseOf(c.input().skeleton, pose));
            CHECK(gap(c) == 0.0);
            for (int e = 0; e < 4; ++e) CHECK(c.positions(e).allFinite());
        }
    }
}

TEST_CASE("smooth joints: the same pose turned gives the same shape turned, and twice the same pose the same bytes") {
    auto c = Character::build(chain({BasisKind::Modes, 12})).value();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Vec3(1, 2, -1).normalized()));
    for (const auto& chainPose : full_joints::standardPoses(4, Vec3::UnitZ())) {
        Pose pose = full_joints::poseOf(c.input().skeleton, chainPose);
        c.update(pose);
        std::vector<Points> before;
        for (int e = 0; e < 4; ++e) before.push_back(c.positions(e));
        c.update(restPose(c.input().skeleton));
        c.update(pose);
        for (int e = 0; e < 4; ++e) CHECK(c.positions(e) == before[static_cast<std::size_t>(e)]);
        for (auto& p : pose.points) p = turn * p + Vec3(3, 0, -1);
        for (auto& q : pose.frames) q = turn * q;
        c.update(pose);
        for (int e = 0; e < 4; ++e) {
            const Points expected = (before[static_cast<std::size_t>(e)] * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(3, 0, -1);
            CHECK((c.positions(e) - expected).cwiseAbs().maxCoeff() < 1e-8);
        }
    }
}

TEST_CASE("smooth joints: extreme drags and stiffness ratios stay finite, and no face turns inside out") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (const double ratio : {1e-6, 1.0, 1e6}) {
        CharacterInput input = chain({BasisKind::Modes, 12}, false);
        input.elements[1].stiffness = ratio;
        auto c = Character::build(input).value();
        Pose pose = restPose(c.input().skeleton);
        for (int k = 0; k < 40; ++k) {
            for (auto& p : pose.points) p = 4.0 * Vec3(d(random), d(random), d(random));
            for (auto& q : pose.frames) q = Eigen::Quaterniond(d(random), d(random), d(random), d(random) + 1.5).normalized();
            c.update(pose);
            CHECK(gap(c) == 0.0);
            for (const auto& joint : c.input().joints) {
                const auto& f = joint.faces[0];
                const auto& face = c.input().elements[f.element].faces[f.face];
                const auto& triangles = c.input().elements[f.element].mesh->body.triangles;
                const Points p = c.positions(f.element);
                REQUIRE(p.allFinite());
                TriangleMesh shown{p, triangles};
                Vec3 sum = Vec3::Zero();
                for (const auto t : face.triangles) sum += areaVector(shown, t);
                for (const auto t : face.triangles) CHECK(areaVector(shown, t).dot(sum) > 0.0);
            }
        }
    }
}

TEST_CASE("smooth joints: a frame allocates nothing") {
    auto c = Character::build(chain({BasisKind::Modes, 12})).value();
    std::vector<Pose> poses;
    for (const auto& pose : full_joints::standardPoses(4, Vec3::UnitZ())) poses.push_back(full_joints::poseOf(c.input().skeleton, pose));
    c.update(poses[0]);
    const auto before = allocations();
    for (const auto& pose : poses) c.update(pose);
    CHECK(allocations() == before);
}

TEST_CASE("smooth joints: the error against the full model falls with the number of modes") {
    const CharacterInput base = chain(BasisKind::Affine);
    const SolverMeshSetting mesh{SolverMeshSetting::Kind::AsIs, 0};
    const full_joints::FullModel model(full_joints::smooth(base, BasisKind::Full, mesh));
    auto affine = Character::build(full_joints::smooth(base, BasisKind::Affine, mesh)).value();
    double last = 1.0;
    for (const char* name : {"affine", "modes:12", "modes:36"}) {
        auto c = Character::build(full_joints::smooth(base, parseBasis(name).value(), mesh)).value();
        full_joints::Difference all;
        for (const auto& chainPose : full_joints::standardPoses(4, Vec3::UnitZ())) {
            const Pose pose = full_joints::poseOf(base.skeleton, chainPose);
            affine.update(pose);
            c.update(pose);
            all.add(full_joints::difference(c, model.solve(affine)));
        }
        MESSAGE(std::string(name) << ": " << all.relative() << ", largest " << all.largest);
        CHECK(all.relative() < last);
        last = all.relative();
    }
}
