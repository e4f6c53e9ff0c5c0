// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/character/character.h"
#include "core/mesh/topology.h"
#include "tests/character/caterpillar.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

Vec3 randomVector(std::mt19937& random, double size) {
    std::uniform_real_distribution<double> d(-size, size);
    const double x = d(random), y = d(random), z = d(random);
    return {x, y, z};
}

Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(const float* data, int n) { return {data, n, 3}; }

Pose moved(const Pose& pose, const Eigen::Quaterniond& turn, const Vec3& shift) {
    Pose out = pose;
    for (auto& p : out.points) p = turn * p + shift;
    for (auto& q : out.frames) q = turn * q;
    return out;
}

// Largest distance between welded vertices, as displayed and as written to files.
double gap(const Character& c) {
    double worst = 0;
    for (const auto& joint : c.input().joints) {
        if (joint.welded.empty()) continue;
        const int a = joint.faces[0].element, b = joint.faces[1].element;
        const auto sa = c.surface(a), sb = c.surface(b);
        const auto pa = rows(sa.positions, sa.vertices), pb = rows(sb.positions, sb.vertices);
        const Points da = c.positions(a), db = c.positions(b);
        for (const auto& [v, w] : joint.welded)
            worst = std::max({worst, (da.row(v) - db.row(w)).norm(), double((pa.row(v) - pb.row(w)).norm())});
    }
    return worst;
}

struct Shown {
    std::vector<std::vector<float>> positions, normals;
    explicit Shown(const Character& c) {
        for (std::size_t e = 0; e < c.input().elements.size(); ++e) {
            const auto s = c.surface(static_cast<int>(e));
            positions.emplace_back(s.positions, s.positions + 3 * s.vertices);
            normals.emplace_back(s.normals, s.normals + 3 * s.vertices);
        }
    }
    [[nodiscard]] double largestMove(const Shown& o) const {
        double m = 0;
        for (std::size_t e = 0; e < positions.size(); ++e)
            for (std::size_t i = 0; i < positions[e].size(); i += 3)
                m = std::max(m, double((Eigen::Map<const Eigen::Vector3f>(&positions[e][i]) - Eigen::Map<const Eigen::Vector3f>(&o.positions[e][i])).norm()));
        return m;
    }
    [[nodiscard]] bool finite() const {
        for (const auto* all : {&positions, &normals})
            for (const auto& e : *all)
                for (const float x : e)
                    if (!std::isfinite(x)) return false;
        return true;
    }
    bool operator==(const Shown& o) const { return positions == o.positions && normals == o.normals; }
};

// A smooth bent, stretched and twisted pose.
Pose bentPose(const Skeleton& skeleton) {
    InverseKinematics ik(skeleton);
    Pose pose = restPose(skeleton);
    const Vec3 tip = skeleton.points.back();
    for (int i = 1; i <= 40; ++i) ik.solve({{0, Vec3::Zero()}, {static_cast<int>(skeleton.points.size()) - 1, tip + i * Vec3(0.05, 0.02, 0.01), true, 0.01 * i}}, pose);
    return pose;
}

}  // namespace

TEST_CASE("character: at rest every vertex is where its mesh has it") {
    for (const bool precomputed : {true, false}) {
        caterpillar::Shape shape;
        shape.precomputed = precomputed;
        auto c = Character::build(caterpillar::make(shape));
        REQUIRE(c);
        for (int e = 0; e < 5; ++e) {
            const auto& rest = c->input().elements[e].mesh->body.vertices;
            CHECK((c->positions(e) - rest).cwiseAbs().maxCoeff() < 1e-14);
            const auto s = c->surface(e);
            CHECK((rows(s.positions, s.vertices).cast<double>() - rest).cwiseAbs().maxCoeff() < 1e-6);
            CHECK((c->jointParameters(e).size() == 0 || c->jointParameters(e).cwiseAbs().maxCoeff() < 1e-14));
        }
    }
}

TEST_CASE("character: a rigid motion of the pose gives the same rigid motion of every vertex") {
    caterpillar::Shape shape;
    shape.tips = true;
    auto c = Character::build(caterpillar::make(shape)).value();
    std::mt19937 random(3);
    for (int i = 0; i < 20; ++i) {
        const Eigen::Quaterniond turn(Eigen::Vector4d(randomVector(random, 1).homogeneous()).normalized());
        const Vec3 shift = randomVector(random, 3.0);
        c.update(moved(restPose(c.input().skeleton), turn, shift));
        CHECK(c.stats().warnings == 0);
        CHECK(c.stats().evaluatedElements == 0);  // v did not change
        for (int e = 0; e < 5; ++e) {
            const Points& rest = c.input().elements[e].mesh->body.vertices;
            const Points expected = ((rest * turn.toRotationMatrix().transpose()).rowwise() + shift.transpose());
            const auto s = c.surface(e);
            CHECK((c.positions(e) - expected).cwiseAbs().maxCoeff() < 5 * 1e-9);
            CHECK((rows(s.positions, s.vertices).cast<double>() - expected).cwiseAbs().maxCoeff() < 5 * 1e-6);
        }
    }
}

TEST_CASE("character: any pose and the same pose moved differ by that motion") {
    auto c = Character::build(caterpillar::make({})).value();
    const Pose pose = bentPose(c.input().skeleton);
    c.update(pose);
    std::vector<Points> before;
    for (int e = 0; e < 5; ++e) before.push_back(c.positions(e));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Vec3(1, 1, 0).normalized()));
    c.update(moved(pose, turn, Vec3(7, 0, -3)));
    for (int e = 0; e < 5; ++e) {
        const Points expected = (before[e] * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(7, 0, -3);
        CHECK((c.positions(e) - expected).cwiseAbs().maxCoeff() < 5 * 1e-9);
    }
}

TEST_CASE("character: the gap between joined faces is exactly zero in every pose and basis") {
    for (const BasisKind basis : {BasisKind::Paper, BasisKind::Affine}) {
        caterpillar::Shape shape;
        shape.basis = basis;
        auto c = Character::build(caterpillar::make(shape)).value();
        REQUIRE(c.input().joints[0].welded.size() > 20);
        CHECK(rc::check("random poses", [&c] {
            std::mt19937 random(*rc::gen::arbitrary<unsigned>());
            Pose pose = restPose(c.input().skeleton);
            InverseKinematics ik(c.input().skeleton);
            for (int i = 0; i < 5; ++i)
                ik.solve({{0, randomVector(random, 3.0)}, {5, randomVector(random, 6.0), true, randomVector(random, 2.0).x()}}, pose);
            c.update(pose);
            RC_ASSERT(gap(c) == 0.0);
            RC_ASSERT(Shown(c).finite());
        }));
    }
}

TEST_CASE("character: unequal tessellations share one motion") {
    caterpillar::Shape shape;
    shape.around = {12, 18};
    auto c = Character::build(caterpillar::make(shape)).value();
    c.update(bentPose(c.input().skeleton));
    CHECK(gap(c) == 0.0);
    // All points of a rim keep their distances to the other rim as far as one affine map lets them: both rims lie in one plane.
    for (const auto& joint : c.input().joints) {
        std::vector<Vec3> all;
        for (const auto& f : joint.faces) {
            const Points p = c.positions(f.element);
            for (const auto v : c.input().elements[f.element].faces[f.face].vertices) all.emplace_back(p.row(v).transpose());
        }
        const Vec3 normal = (all[4] - all[0]).cross(all[9] - all[0]).normalized();
        for (const auto& p : all) CHECK(std::abs(normal.dot(p - all[0])) < 1e-9);
    }
    // Normals at rim vertices meet those of the other side.
    const auto& joint = c.input().joints[1];
    const auto a = c.surface(1), b = c.surface(2);
    int compared = 0;
    for (const auto& [v, w] : joint.welded) {
        if (c.input().elements[1].mesh->body.vertices.row(v).head<2>().norm() < 0.4) continue;
        CHECK((rows(a.normals, a.vertices).row(v) - rows(b.normals, b.vertices).row(w)).norm() < 1e-6);
        ++compared;
    }
    CHECK(compared == 6);
}

TEST_CASE("character: welded rim vertices have one normal, all normals are unit and point outward") {
    auto c = Character::build(caterpillar::make({})).value();
    c.update(bentPose(c.input().skeleton));
    for (const auto& joint : c.input().joints) {
        const auto a = c.surface(joint.faces[0].element), b = c.surface(joint.faces[1].element);
        int same = 0;
        for (const auto& [v, w] : joint.welded)
            if (std::memcmp(a.normals + 3 * v, b.normals + 3 * w, 12) == 0) ++same;
        CHECK(same == 12);  // the rim; vertices inside face away from each other
    }
    for (int e = 0; e < 5; ++e) {
        const auto s = c.surface(e);
        const auto n = rows(s.normals, s.vertices);
        for (int v = 0; v < s.vertices; ++v) CHECK(n.row(v).norm() == doctest::Approx(1.0).epsilon(1e-5));
    }
    // A straight cylinder: the rim's normal is the one of its side, not of the hidden cap.
    c.update(restPose(c.input().skeleton));
    const auto s = c.surface(1);
    for (const auto& [v, w] : c.input().joints[1].welded) {
        const auto p = rows(s.positions, s.vertices).row(v);
        if (p.head<2>().norm() < 0.49f) continue;
        CHECK(std::abs(rows(s.normals, s.vertices)(v, 2)) < 1e-5f);
        CHECK(rows(s.normals, s.vertices).row(v).head<2>().dot(p.head<2>().normalized()) > 0.99f);
    }
}

TEST_CASE("character: single precision follows double precision") {
    caterpillar::Shape shape;
    shape.tips = true;
    auto c = Character::build(caterpillar::make(shape)).value();
    const Pose pose = bentPose(c.input().skeleton);
    c.update(pose);
    for (int e = 0; e < 5; ++e) {
        const auto s = c.surface(e);
        CHECK((rows(s.positions, s.vertices).cast<double>() - c.positions(e)).cwiseAbs().maxCoeff() < 5 * 1e-6);
    }
    CHECK(c.stats().evaluatedElements == 5);
    CHECK(c.jointParameters(2).cwiseAbs().maxCoeff() > 0.01);
}

TEST_CASE("character: an element with a single joint face follows its bone rigidly, the others deform") {
    auto c = Character::build(caterpillar::make({})).value();
    Pose pose = restPose(c.input().skeleton);
    InverseKinematics ik(c.input().skeleton);
    // Bend without stretch of the ends: v of the end elements holds nothing but the in-plane stretch of their joint.
    for (int i = 1; i <= 30; ++i) ik.solve({{0, Vec3::Zero()}, {5, Vec3(0.04 * i, 0, 5 - 0.02 * i)}}, pose);
    c.update(pose);
    for (const int e : {0, 4}) {
        const auto& v = c.jointParameters(e);
        for (Eigen::Index i = 0; i < v.size(); ++i)
            if (i != 0 && i != 2) CHECK(std::abs(v[i]) < 1e-12);
        const auto& bone = c.input().skeleton.bones[e];
        const Vec3 along = (pose.points[bone.end] - pose.points[bone.start]).normalized();
        CHECK((c.frame(e).linear() * Vec3::UnitZ() - along).norm() < 1e-9);
    }
    CHECK(c.jointParameters(2).cwiseAbs().maxCoeff() > 1e-3);
}

TEST_CASE("character: a stretched body gets thinner and nearly keeps its volume") {
    caterpillar::Shape shape;
    shape.tips = true;
    shape.around = {16};
    auto c = Character::build(caterpillar::make(shape)).value();
    Pose pose = restPose(c.input().skeleton);
    const auto total = [&c] {
        double sum = 0;
        for (int e = 0; e < 5; ++e) sum += enclosedVolume(c.positions(e), c.input().elements[e].mesh->body.triangles);
        return sum;
    };
    const double rest = total();
    for (auto& p : pose.points) p *= 1.1;
    c.update(pose);
    for (int j = 0; j < 6; ++j) CHECK(c.lateralContraction(j) < 0.0);
    // nu = 0.45: uniaxial tension by 10 % leaves 1.1 * (1 - 0.045)^2 = 1.003 of the volume.
    CHECK(total() / rest == doctest::Approx(1.003).epsilon(0.02));
}

TEST_CASE("character: twist shows in affine, and paper says that it loses it") {
    for (const BasisKind basis : {BasisKind::Paper, BasisKind::Affine}) {
        caterpillar::Shape shape;
        shape.basis = basis;
        shape.tips = true;
        auto c = Character::build(caterpillar::make(shape)).value();
        Pose pose = restPose(c.input().skeleton);
        std::vector<IkGoal> goals = {{0, Vec3::Zero(), true, 0.0}, {5, Vec3(0, 0, 5), true, 1.0}};
        c.solvePose(goals, pose);
        c.update(pose);
        const bool warned = c.stats().warnings & static_cast<unsigned>(FrameWarning::BasisLosesTwist);
        CHECK(warned == (basis == BasisKind::Paper));
        // Every joint turns by its part of the twist about the axis.
        for (int j = 0; j + 1 < 5; ++j) {
            const auto& f = c.input().joints[j].faces[0];
            const Points now = c.positions(f.element);
            const Points& rest = c.input().elements[f.element].mesh->body.vertices;
            for (const auto v : c.input().elements[f.element].faces[f.face].vertices) {
                const Vec3 turned = Eigen::AngleAxisd(0.2 * (j + 1), Vec3::UnitZ()) * Vec3(rest.row(v).transpose());
                CHECK((Vec3(now.row(v).transpose()) - turned).norm() < 1e-9);
            }
        }
        c.update(restPose(c.input().skeleton));
        CHECK(c.stats().warnings == 0);
    }
}

TEST_CASE("character: out of reach is said, and so is a pose that is not a number") {
    auto c = Character::build(caterpillar::make({})).value();
    Pose pose = restPose(c.input().skeleton);
    for (int i = 0; i < 50; ++i) c.solvePose({{0, Vec3::Zero()}, {5, Vec3(0, 100, 0)}}, pose);
    c.update(pose);
    CHECK(c.stats().warnings == static_cast<unsigned>(FrameWarning::TargetOutOfReach));
    const Shown good(c);
    Pose bad = pose;
    bad.points[2].x() = std::numeric_limits<double>::infinity();
    c.update(bad);
    CHECK((c.stats().warnings & static_cast<unsigned>(FrameWarning::PoseRefused)) != 0);
    CHECK(Shown(c) == good);
}

TEST_CASE("character: elements whose v did not change are not evaluated, those that did not move are left alone") {
    auto c = Character::build(caterpillar::make({})).value();
    Pose pose = bentPose(c.input().skeleton);
    c.update(pose);
    const auto revision = c.surface(2).revision;
    c.update(pose);
    CHECK(c.stats().evaluatedElements == 0);
    CHECK(c.surface(2).revision == revision);

    // The last bone bends: the joint before it tilts, so elements 3 and 4 see it; 0, 1 and 2 do not.
    const Shown before(c);
    pose.points[5] += Vec3(0.1, 0, 0);
    const Vec3 old = pose.frames[4] * Vec3::UnitZ(), along = (pose.points[5] - pose.points[4]).normalized();
    pose.frames[4] = Eigen::Quaterniond::FromTwoVectors(old, along) * pose.frames[4];
    c.update(pose);
    const Shown after(c);
    CHECK(c.stats().evaluatedElements >= 1);
    CHECK(c.stats().evaluatedElements <= 2);
    for (int e = 0; e < 3; ++e) CHECK(before.positions[e] == after.positions[e]);
    CHECK(before.positions[4] != after.positions[4]);

    auto fresh = Character::build(caterpillar::make({})).value();
    fresh.update(pose);
    CHECK(Shown(fresh).largestMove(after) < 1e-5);
}

TEST_CASE("character: a random walk of 10,000 steps neither jumps nor opens a seam, twice with the same bytes") {
    for (const bool tips : {false, true}) {
        caterpillar::Shape shape;
        shape.around = {8};
        shape.along = {3};
        shape.tips = tips;
        const CharacterInput input = caterpillar::make(shape);
        auto c = Character::build(input).value(), twin = Character::build(input).value();
        Pose pose = restPose(input.skeleton), twinPose = pose;
        std::mt19937 random(11);
        const double step = 0.05;  // one percent of the length
        Vec3 target(0, 0, 5), velocity = Vec3::Zero();
        Shown last(c);
        double largest = 0, open = 0;
        bool finite = true, same = true;
        for (int i = 0; i < 10000; ++i) {
            velocity = (velocity + randomVector(random, 0.5)).normalized();
            if (i % 1500 > 1100) velocity = (pose.points[i % 3] - target + 1e-3 * velocity).normalized();
            if (target.norm() > 40.0) velocity = -target.normalized();
            target += step * velocity;
            const std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {5, target}};
            c.solvePose(goals, pose);
            c.update(pose);
            twin.solvePose(goals, twinPose);
            twin.update(twinPose);
            const Shown now(c);
            largest = std::max(largest, now.largestMove(last));
            finite = finite && now.finite();
            same = same && now == Shown(twin);
            if (i % 10 == 0) open = std::max(open, gap(c));
            last = now;
        }
        MESSAGE("largest move of a vertex in a frame, in drag steps: " << largest / step);
        CHECK(finite);
        CHECK(same);
        CHECK(open == 0.0);
        CHECK(largest <= 10 * step);
    }
}

TEST_CASE("character: a frame allocates nothing") {
    auto c = Character::build(caterpillar::make({})).value();
    Pose pose = restPose(c.input().skeleton);
    std::vector<IkGoal> goals = {{0, Vec3::Zero()}, {5, Vec3(0, 0, 5), true, 0.1}};
    c.solvePose(goals, pose);
    c.update(pose);
    const auto before = allocations();
    for (int i = 0; i < 20; ++i) {
        goals[1].target += Vec3(0.05, 0.01, 0);
        c.solvePose(goals, pose);
        c.update(pose);
    }
    CHECK(allocations() == before);
}

TEST_CASE("character: input that contradicts itself is refused") {
    const CharacterInput good = caterpillar::make({});
    const auto refused = [&good](auto change) {
        CharacterInput input = good;
        change(input);
        const auto c = Character::build(std::move(input));
        return !c && c.error().code == "bad-value";
    };
    CHECK(Character::build(good).has_value());
    CHECK(refused([](auto& i) { i.joints.pop_back(); }));
    CHECK(refused([](auto& i) { i.joints[0].faces[0].element = 9; }));
    CHECK(refused([](auto& i) { i.joints[0].point = 77; }));
    CHECK(refused([](auto& i) { i.elements[0].mesh = nullptr; }));
    CHECK(refused([](auto& i) { i.elements[0].bones = {12}; }));
    CHECK(refused([](auto& i) { i.elements[1].response = i.elements[0].response; }));
    CHECK(refused([](auto& i) { i.skeleton.bones[1].end = i.skeleton.bones[1].start; }));
    CHECK(refused([](auto& i) { i.joints[0].welded.emplace_back(100000, 0); }));
}

TEST_CASE("character: nothing to show, no bones, no faces") {
    auto empty = Character::build({});
    REQUIRE(empty);
    Pose pose;
    empty->update(pose);
    CHECK(empty->solvePose({}, pose).converged);

    caterpillar::Shape shape;
    shape.elements = 1;
    shape.precomputed = false;
    CharacterInput alone = caterpillar::make(shape);
    alone.elements[0].bones.clear();
    alone.skeleton = {};
    auto c = Character::build(alone).value();
    c.update(restPose(alone.skeleton));
    CHECK((c.positions(0) - alone.elements[0].mesh->body.vertices).norm() == 0.0);
}

TEST_CASE("one element: a rigid motion of its faces gives the same rigid motion, eq. (5) moves the faces exactly") {
    caterpillar::Shape shape;
    shape.elements = 1;
    shape.tips = true;
    const auto input = caterpillar::make(shape);
    const auto& element = input.elements[0];
    const auto& response = *element.response;
    Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
    const Vec3 shift(0.1, 0.2, -0.3);
    for (std::size_t f = 0; f < 2; ++f) {
        JointMap map;
        map.shift = element.faces[f].frame.axes.transpose() * shift;
        double lost = 0;
        response.bases[f].coefficients(map, 1.0, v.data() + response.firstColumn[f], lost);
    }
    const Points moved = deformElement(*element.mesh, element.faces, response, v);
    CHECK(((moved - element.mesh->body.vertices).rowwise() - shift.transpose()).cwiseAbs().maxCoeff() < 1e-9);

    const PaperParameters p{1.2, 0.9, 0.3, 0.2, 0.1};
    v.setZero();
    double lost = 0;
    response.bases[1].coefficients(jointMap(p), 1.0, v.data() + response.firstColumn[1], lost);
    const Points bent = deformElement(*element.mesh, element.faces, response, v);
    const auto& frame = element.faces[1].frame;
    for (const auto i : element.faces[1].vertices) {
        const Vec3 local = frame.toLocal(element.mesh->body.vertices.row(i).transpose());
        CHECK((frame.toWorld(jointMap(p).linear * local + jointMap(p).shift) - Vec3(bent.row(i).transpose())).norm() < 1e-12);
    }
    for (const auto i : element.faces[0].vertices) CHECK((bent.row(i) - element.mesh->body.vertices.row(i)).norm() == 0.0);
}
