// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>

#include "core/character/character.h"
#include "core/effects/joint_equilibrium.h"
#include "core/effects/smooth_joints_job.h"
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
    shape.mirrored = true;
    CharacterInput input = caterpillar::make(shape);
    input.effects.set(SmoothJointsEffect{});
    return input;
}

double seamGap(const Character& c) {
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
            CHECK(seamGap(c) == 0.0);
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
            CHECK(seamGap(c) == 0.0);
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

TEST_CASE("smooth joints: the error against the full model falls with the number of modes, and 12 leave less than 1 %") {
    const CharacterInput base = chain(BasisKind::Affine);
    const SolverMeshSetting mesh{SolverMeshSetting::Kind::AsIs, 0};
    const full_joints::FullModel model(full_joints::smooth(base, BasisKind::Full, mesh));
    auto affine = Character::build(full_joints::smooth(base, BasisKind::Affine, mesh)).value();
    double strict = 1.0, relative = 1.0;
    for (const char* name : {"affine", "modes:5", "modes:12", "modes:36"}) {
        auto c = Character::build(full_joints::smooth(base, parseBasis(name).value(), mesh)).value();
        full_joints::Difference all;
        for (const auto& chainPose : full_joints::standardPoses(4, Vec3::UnitZ())) {
            const Pose pose = full_joints::poseOf(base.skeleton, chainPose);
            affine.update(pose);
            c.update(pose);
            all.add(full_joints::difference(c, model.solve(affine)));
        }
        MESSAGE(std::string(name) << ": " << 100.0 * all.relative() << " % (" << 100.0 * all.strict() << " % in moving frames), largest "
                                  << 100.0 * all.largest << " %");
        CHECK(all.strict() < strict);
        CHECK(all.relative() < relative);
        if (c.input().basis.modes >= 12) CHECK(all.relative() < 0.01);
        strict = all.strict();
        relative = all.relative();
    }
}

TEST_CASE("smooth joints: joints in equilibrium never have more energy than rigid ones") {
    std::mt19937 random(11);
    std::normal_distribution<double> d(0.0, 0.02);  // strains that nothing bounds
    for (const char* name : {"paper", "affine", "modes:5", "modes:12", "modes:36"}) {
        CAPTURE(name);
        const CharacterInput input = chain(parseBasis(name).value(), false);
        JointEquilibrium joints(input);
        for (int k = 0; k < 20; ++k) {
            for (std::size_t j = 0; j < input.joints.size(); ++j)
                joints.setJoint(static_cast<int>(j), Eigen::AngleAxisd(20.0 * d(random), Vec3(1, 2, 3).normalized()).toRotationMatrix());
            for (std::size_t e = 0; e < input.elements.size(); ++e)
                joints.setElement(static_cast<int>(e), Eigen::AngleAxisd(20.0 * d(random), Vec3(3, -1, 1).normalized()).toRotationMatrix(),
                                  Eigen::VectorXd::NullaryExpr(input.elements[e].response->columns(), [&] { return d(random); }));
            REQUIRE(joints.solve());
            CHECK(joints.energy() <= joints.rigidEnergy());
            CHECK(joints.energy() >= 0.0);
        }
    }
}

TEST_CASE("smooth joints: tables of what did not change are taken over, and solve to the same bytes") {
    std::mt19937 random(5);
    std::normal_distribution<double> d(0.0, 0.2);
    CharacterInput input = chain(parseBasis("modes:12").value());
    const JointEquilibrium before(input);
    const JointEquilibrium* known[] = {&before};
    const auto asked = [&](std::span<const JointEquilibrium* const> of) {
        const std::size_t start = allocations();
        (void)JointEquilibrium(input, of);
        return allocations() - start;
    };
    const std::size_t whole = asked({}), none = asked(known);
    CharacterInput edited = input;
    edited.elements[1].stiffness *= 0.5;
    edited.elements[2].response = std::make_shared<const ElementResponse>(*edited.elements[2].response);
    edited.skeleton.points[static_cast<std::size_t>(edited.joints[1].point)] += Vec3(0.01, 0.0, 0.02);
    std::swap(input, edited);
    const std::size_t some = asked(known);
    MESSAGE("memory is asked for " << whole << " times without, " << none << " times with the same, " << some << " times with half of it changed");
    CHECK(2 * none < whole);
    CHECK(none < some);
    CHECK(some < whole);
    JointEquilibrium taken(input, known), fresh(input);
    for (int k = 0; k < 5; ++k) {
        for (std::size_t j = 0; j < input.joints.size(); ++j) {
            const Eigen::Matrix3d turn = Eigen::AngleAxisd(d(random), Vec3(1, 2, 3).normalized()).toRotationMatrix();
            taken.setJoint(static_cast<int>(j), turn);
            fresh.setJoint(static_cast<int>(j), turn);
        }
        for (std::size_t e = 0; e < input.elements.size(); ++e) {
            const Eigen::Matrix3d turn = Eigen::AngleAxisd(d(random), Vec3(3, -1, 1).normalized()).toRotationMatrix();
            const Eigen::VectorXd rigid = Eigen::VectorXd::NullaryExpr(input.elements[e].response->columns(), [&] { return 0.1 * d(random); });
            taken.setElement(static_cast<int>(e), turn, rigid);
            fresh.setElement(static_cast<int>(e), turn, rigid);
        }
        REQUIRE(taken.solve());
        REQUIRE(fresh.solve());
        for (std::size_t e = 0; e < input.elements.size(); ++e) CHECK(taken.parameters(static_cast<int>(e)) == fresh.parameters(static_cast<int>(e)));
        for (std::size_t j = 0; j < input.joints.size(); ++j) CHECK(taken.stretch(static_cast<int>(j)) == fresh.stretch(static_cast<int>(j)));
    }
}

TEST_CASE("smooth joints: faces that are not flat stay closed, and rest at rest") {
    caterpillar::Shape shape;
    shape.elements = 3;
    shape.basis = {BasisKind::Modes, 12};
    shape.mirrored = true;
    shape.dome = 0.4;
    CharacterInput input = caterpillar::make(shape);
    REQUIRE(!input.elements[1].faces[0].flat());
    input.effects.set(SmoothJointsEffect{});
    auto c = Character::build(input).value();
    for (int e = 0; e < 3; ++e) CHECK((c.positions(e) - c.input().elements[e].mesh->body.vertices).cwiseAbs().maxCoeff() < 1e-9);
    for (const auto& pose : full_joints::standardPoses(3, Vec3::UnitZ())) {
        c.update(full_joints::poseOf(c.input().skeleton, pose));
        CHECK(seamGap(c) == 0.0);
        for (int e = 0; e < 3; ++e) CHECK(c.positions(e).allFinite());
    }
}

TEST_CASE("smooth joints: switched off, nothing warps, whatever the basis, and no time goes there") {
    CharacterInput input = chain({BasisKind::Modes, 5});
    input.effects.erase<SmoothJointsEffect>();
    auto c = Character::build(input).value();
    for (const auto& chainPose : full_joints::standardPoses(4, Vec3::UnitZ())) {
        c.update(full_joints::poseOf(input.skeleton, chainPose));
        CHECK(c.stats().effectMs(SmoothJointsEffect::kName) == 0.0);
        for (int e = 0; e < 4; ++e) {
            const auto& response = *input.elements[e].response;
            for (std::size_t f = 0; f < response.bases.size(); ++f)
                CHECK(c.jointParameters(e).segment(response.firstColumn[f] + response.bases[f].plainColumns(), 5) == Eigen::VectorXd::Zero(5));
        }
    }
}

TEST_CASE("smooth joints: where a trunk meets two branches in one joint of three faces, the seam stays closed") {
    CharacterInput input;
    input.basis = {BasisKind::Modes, 12};
    input.effects.set(SmoothJointsEffect{});
    input.skeleton.points = {Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(-0.25, 0, 2), Vec3(0.25, 0, 2)};
    for (const auto& [end, parent] : {std::pair(1, -1), std::pair(2, 0), std::pair(3, 0)}) {
        const int start = parent < 0 ? 0 : 1;
        input.skeleton.bones.push_back({start, end, parent, (input.skeleton.points[end] - input.skeleton.points[start]).norm()});
    }
    const std::vector<shapes::Body> bodies = {shapes::box(Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, 1), 4, 4, 3),
                                              shapes::box(Vec3(-0.5, -0.5, 1), Vec3(0, 0.5, 2), 2, 4, 3),
                                              shapes::box(Vec3(0, -0.5, 1), Vec3(0.5, 0.5, 2), 2, 4, 3)};
    CharacterInput::Joint joint;
    joint.point = 1;
    for (int e = 0; e < 3; ++e) {
        const auto& body = bodies[static_cast<std::size_t>(e)];
        CharacterInput::Element element;
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = body.mesh;
        element.mesh = mesh;
        element.bones = {e};
        element.faces.push_back(caterpillar::faceOf(body.mesh, body.ends[e == 0 ? 1 : 0], "face"));
        input.elements.push_back(element);
        joint.faces.push_back({e, 0, e});
    }
    caterpillar::weld(input, joint);
    input.joints.push_back(joint);
    caterpillar::precompute(input);
    auto c = Character::build(input).value();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> d(-0.3, 0.3);
    for (int k = 0; k < 10; ++k) {
        Pose pose = restPose(input.skeleton);
        for (auto& p : pose.points) p += Vec3(d(random), d(random), d(random));
        c.update(pose);
        for (const auto a : input.elements[0].faces[0].vertices)
            for (int e = 1; e < 3; ++e)
                for (const auto b : input.elements[e].faces[0].vertices)
                    if ((bodies[0].mesh.vertices.row(a) - bodies[static_cast<std::size_t>(e)].mesh.vertices.row(b)).norm() < 1e-9)
                        CHECK((c.positions(0).row(a) - c.positions(e).row(b)).norm() < 1e-9);
    }
}
