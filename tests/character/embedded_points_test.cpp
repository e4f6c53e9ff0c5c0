// SPDX-License-Identifier: GPL-3.0-or-later
// Render meshes apart from bodies.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/finite.h"
#include "core/character/deform_input.h"
#include "core/reduction/embedded_mapping.h"
#include "core/effects/touch_job.h"
#include "tests/character/embedded.h"
#include "tests/character/random_characters.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

using Rows = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>;

Rows positionsOf(const Character& c, int mesh = 0) {
    const auto s = c.renderSurface(mesh);
    return {s.positions, s.vertices, 3};
}

Rows normalsOf(const Character& c, int mesh = 0) {
    const auto s = c.renderSurface(mesh);
    return {s.normals, s.vertices, 3};
}

bool finite(const Character& c) {
    for (int m = 0; m < static_cast<int>(c.input().renderMeshes.size()); ++m) {
        const auto s = c.renderSurface(m);
        const auto count = 3 * static_cast<std::size_t>(s.vertices);
        if (!allFinite(s.positions, count) || !allFinite(s.normals, count) || !allFinite(c.renderPositions(m))) return false;
    }
    return true;
}

bool sameBytes(const Character& a, const Character& b) {
    for (int m = 0; m < static_cast<int>(a.input().renderMeshes.size()); ++m) {
        const auto s = a.renderSurface(m), t = b.renderSurface(m);
        if (!std::equal(s.positions, s.positions + 3 * s.vertices, t.positions) || !std::equal(s.normals, s.normals + 3 * s.vertices, t.normals)) return false;
    }
    return true;
}

/// Two cylinders of length 1 and radius .5 that meet in the same caps, held by their bones at both ends.
CharacterInput two(int around = 16, int along = 6) {
    caterpillar::Shape shape;
    shape.elements = 2;
    shape.around = {around};
    shape.along = {along};
    shape.tips = shape.mirrored = true;
    return caterpillar::make(shape);
}

/// The same under one tube that is larger by 3 % of the diagonal, and denser than the bodies.
CharacterInput underTube(int around = 16, int along = 6) {
    CharacterInput input = two(around, along);
    embedded::addRenderMesh(input, embedded::tube(0.5 + 0.03 * std::sqrt(6.0), 0.05, 1.95, 48, 75), 1.0);
    return input;
}

TriangleMesh unionOf(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh out;
    out.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    out.vertices << a.vertices, b.vertices;
    out.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    out.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return out;
}

Pose movedPose(const Pose& pose, const Eigen::Quaterniond& turn, const Vec3& shift) {
    Pose out = pose;
    for (auto& p : out.points) p = turn * p + shift;
    for (auto& q : out.frames) q = turn * q;
    return out;
}

std::vector<Pose> standardPoses(const Skeleton& skeleton) {
    std::vector<Pose> out;
    for (const double degrees : {30.0, 60.0, 90.0}) out.push_back(embedded::chainPose(skeleton, degrees * std::numbers::pi / 180.0, 0.0, 1.0));
    out.push_back(embedded::chainPose(skeleton, 0.0, 45.0 * std::numbers::pi / 180.0, 1.0));
    out.push_back(embedded::chainPose(skeleton, 0.0, 0.0, 1.3));
    return out;
}

/// With what the effects of a test need of responses.
CharacterInput withResponses(CharacterInput input, bool loads, int touch) {
    for (auto& element : input.elements) {
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.basis = input.basis;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        in.loads = loads ? BodyLoads::Always : BodyLoads::None;
        in.touch = touch;
        element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
    return input;
}

}  // namespace

TEST_CASE("embedded mapping: rigid motions, and constant strain without traction away from faces, are exact, on the surface, beside it and inside") {
    const auto body = shapes::bar(4, 3.0);
    std::vector<JointFace> faces = {caterpillar::faceOf(body.mesh, body.ends[0], "low"), caterpillar::faceOf(body.mesh, body.ends[1], "high")};
    const std::vector<char> covered = {1, 0};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    Points points(300, 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) << 0.7 * d(random), 0.7 * d(random), 1.5 + 0.5 * d(random);
    const double nu = 0.4;
    EmbeddedMapping::Input in;
    in.body = &body.mesh, in.faces = faces, in.covered = covered, in.points = &points, in.nu = nu;
    const auto mapping = EmbeddedMapping::build(in).value();
    CHECK(mapping.jointParts().empty());  // the faces are farther than twice the distance of any point

    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const Eigen::Matrix3d strain = Vec3(-nu, -nu, 1.0).asDiagonal();
    const auto apply = [&](const Eigen::Matrix3d& gradient, const Vec3& shift) {
        const Points u = (body.mesh.vertices * gradient.transpose()).rowwise() + shift.transpose();
        const Eigen::MatrixXd out = mapping.apply(Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()), 1);
        return Points(Eigen::Map<const Points>(out.data(), points.rows(), 3));
    };
    const auto exact = [&](const Eigen::Matrix3d& gradient, const Vec3& shift) { return Points((points * gradient.transpose()).rowwise() + shift.transpose()); };
    Eigen::Matrix3d skew;
    skew << 0, -1, 2, 1, 0, 0.5, -2, -0.5, 0;
    const Vec3 shift(1, -2, 3);
    CHECK((apply(skew, shift) - exact(skew, shift)).cwiseAbs().maxCoeff() < 1e-12);  // rigid, to first order
    CHECK((apply(strain, shift) - exact(strain, shift)).cwiseAbs().maxCoeff() < 1e-12);

    // Deformed positions: rotations of any size.
    const Points moved = (body.mesh.vertices * turn.transpose()).rowwise() + shift.transpose();
    auto gradients = mapping.gradients();
    mapping.findTriangles(EmbeddedMapping::Values::Positions, moved.data(), 0, mapping.triangles(), gradients);
    mapping.findVertices(0, mapping.vertices(), gradients);
    for (std::size_t i = 0; i < mapping.size(); ++i) {
        const Vec3 wanted = turn * points.row(static_cast<Eigen::Index>(i)).transpose() + shift;
        CHECK((mapping.at(i, moved.data(), gradients) - wanted).norm() < 1e-12);
    }
}

TEST_CASE("embedded mapping: deformed positions and displacements agree to first order") {
    const auto body = shapes::bar(4, 3.0);
    const auto tube = embedded::tube(0.8, 0.3, 2.7, 20, 30);
    EmbeddedMapping::Input in;
    in.body = &body.mesh, in.points = &tube.vertices;
    const auto mapping = EmbeddedMapping::build(in).value();
    Points u(body.mesh.vertices.rows(), 3);
    for (Eigen::Index v = 0; v < u.rows(); ++v) {
        const Vec3 x = body.mesh.vertices.row(v).transpose();
        u.row(v) << std::sin(x.z()), x.x() * x.z(), std::cos(2.0 * x.y());
    }
    const auto difference = [&](double size) {
        const Eigen::VectorXd small = size * Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
        const Eigen::MatrixXd linear = mapping.apply(small, 1);
        const Points moved = body.mesh.vertices + size * u;
        auto gradients = mapping.gradients();
        mapping.findTriangles(EmbeddedMapping::Values::Positions, moved.data(), 0, mapping.triangles(), gradients);
        mapping.findVertices(0, mapping.vertices(), gradients);
        double worst = 0.0;
        for (std::size_t i = 0; i < mapping.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            const Vec3 sum = tube.vertices.row(row).transpose() + linear.col(0).segment<3>(3 * row);
            worst = std::max(worst, (mapping.at(i, moved.data(), gradients) - sum).norm());
        }
        return worst;
    };
    // Second order: a hundredth of the difference at a tenth of the size.
    CHECK(difference(1e-4) < 0.011 * difference(1e-3));
    CHECK(difference(1e-3) < 1e-4);
}

TEST_CASE("embedded mapping: a point near one side of a thin wall follows that side, if its normal says so") {
    const auto wall = shapes::box(Vec3(0, 0, 0), Vec3(2, 2, 0.1), 8, 8, 1);
    Points points(2, 3), normals(2, 3);
    points << 1.03, 1.01, 0.04, 1.03, 1.01, 0.04;  // a little nearer to the lower side
    normals << 0, 0, 1, 0, 0, -1;
    EmbeddedMapping::Input in;
    in.body = &wall.mesh, in.points = &points, in.normals = &normals, in.nu = 0.0;
    const auto mapping = EmbeddedMapping::build(in).value();
    // The upper side alone is shifted.
    Points u = Points::Zero(wall.mesh.vertices.rows(), 3);
    for (Eigen::Index v = 0; v < u.rows(); ++v)
        if (wall.mesh.vertices(v, 2) > 0.05) u(v, 0) = 1.0;
    const Eigen::MatrixXd moved = mapping.apply(Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()), 1);
    CHECK(moved(0, 0) == doctest::Approx(1.0));
    CHECK(moved(3, 0) == doctest::Approx(0.0));
}

TEST_CASE("render mesh: a rigid motion of the pose is one of every vertex, in the order of the file") {
    CharacterInput input = underTube();
    const Points rest = embedded::tube(0.5 + 0.03 * std::sqrt(6.0), 0.05, 1.95, 48, 75).vertices;
    auto c = Character::build(input).value();
    CHECK(c.renderRestPositions(0) == rest);
    CHECK((c.renderPositions(0) - rest).cwiseAbs().maxCoeff() < 1e-14);
    CHECK((positionsOf(c).cast<double>() - rest).cwiseAbs().maxCoeff() < 1e-6);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Vec3(1, -1, 0.5).normalized()));
    const Vec3 shift(1, 2, -3);
    c.update(movedPose(restPose(input.skeleton), turn, shift));
    const Points wanted = (rest * turn.toRotationMatrix().transpose()).rowwise() + shift.transpose();
    CHECK((c.renderPositions(0) - wanted).cwiseAbs().maxCoeff() < 1e-13);
    CHECK((positionsOf(c).cast<double>() - wanted).cwiseAbs().maxCoeff() < 3e-6);
}

TEST_CASE("render mesh: points at body vertices are these in every pose, bit for bit, and whoever asks for the body gets what it would be without a render mesh") {
    std::mt19937 random(11);
    for (int kind = 0; kind < 14; ++kind) {
        CAPTURE(kind);
        const CharacterInput plain = randomCharacter(random);
        // All of the first body, every third vertex of the second, and some points besides.
        CharacterInput input = plain;
        auto mesh = std::make_shared<EmbeddedMesh>();
        for (int e = 0; e < 2; ++e) {
            const Points& body = input.elements[static_cast<std::size_t>(e)].mesh->body.vertices;
            auto own = std::make_shared<EmbeddedPoints>();
            own->rest = e == 0 ? body : Points(body.rowwise() + 0.01 * (body.row(1) - body.row(0)));
            own->bodyVertex.assign(static_cast<std::size_t>(body.rows()), -1);
            for (Eigen::Index v = 0; v < body.rows(); ++v) {
                if (e == 0 || v % 3 == 0) own->bodyVertex[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(v), own->rest.row(v) = body.row(v);
                mesh->vertices.push_back({e, static_cast<std::int32_t>(v), e == 0 && v % 2 == 0});
            }
            input.elements[static_cast<std::size_t>(e)].embedded = own;
        }
        mesh->triangles = input.elements[0].mesh->body.triangles;
        input.renderMeshes.push_back(mesh);
        auto c = Character::build(input).value(), without = Character::build(plain).value();
        for (Character* which : {&c, &without}) which->keepExact(true);
        // Modes of the product rest on all rows of an element: bodies agree to single precision, and exactly without embedded rows.
        Pose pose = restPose(input.skeleton);
        for (int frame = 0; frame < 8; ++frame) {
            wander(c, random, pose);
            if (input.effects.has<TouchEffect>() && frame == 3) {
                const Vec3 at = plain.elements[1].mesh->body.vertices.row(0).transpose();
                for (Character* which : {&c, &without}) (void)setFinger(*which, 1, 0, at, 0.9 * at, 0.0);
            }
            c.update(pose, 1.0 / 60.0);
            without.update(pose, 1.0 / 60.0);
            const Points shown = positionsOf(c).cast<double>(), exact = c.renderPositions(0);
            Eigen::Index row = 0;
            for (int e = 0; e < 2; ++e) {
                const auto body = c.surface(e), other = without.surface(e);
                const Points inDouble = c.positions(e);
                const double size = (inDouble.colwise().maxCoeff() - inDouble.colwise().minCoeff()).norm() + inDouble.cwiseAbs().maxCoeff();
                for (int v = 0; v < body.vertices; ++v, ++row) {
                    if (e == 0 || v % 3 == 0) {
                        CHECK(shown.row(row) == Rows(body.positions, body.vertices, 3).row(v).cast<double>());
                        CHECK(exact.row(row) == inDouble.row(v));
                    }
                    const double apart = (Rows(body.positions, body.vertices, 3).row(v) - Rows(other.positions, body.vertices, 3).row(v)).norm();
                    CHECK(apart <= (e == 0 ? 0.0 : input.format == ResponseFormat::Float ? 1e-5 * size : 2e-3 * size));
                }
                // Normals on a seam know the other element, too.
                if (e == 0) CHECK((Rows(body.normals, body.vertices, 3) - Rows(other.normals, body.vertices, 3)).rowwise().norm().maxCoeff() < 0.05f);
            }
            CHECK(finite(c));
        }
    }
}

namespace {

/// How far edges of the tube of underTube() are stretched: those between the last row of one element and the first of the other, and those of the rows beside.
struct Stretch {
    double over = 0.0, beside = 0.0;
};

Stretch stretchAtJoint(const Character& c) {
    const Points &rest = c.renderRestPositions(0), now = c.renderPositions(0);
    const Triangles& triangles = c.input().renderMeshes[0]->triangles;
    Stretch out;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const auto a = triangles(t, k), b = triangles(t, (k + 1) % 3);
            const double stretch = (now.row(a) - now.row(b)).norm() / (rest.row(a) - rest.row(b)).norm();
            const std::int32_t low = std::min(a / 48, b / 48), high = std::max(a / 48, b / 48);
            if (low == 37 && high == 38) out.over = std::max(out.over, stretch);
            if ((low >= 36 && high <= 37) || (low >= 38 && high <= 39)) out.beside = std::max(out.beside, stretch);
        }
    return out;
}

}  // namespace

TEST_CASE("render mesh: over a joint of two equal caps edges stretch no more than 1.2 times those of the rows beside it") {
    double worst = 0.0;
    for (const bool warped : {false, true}) {
        for (const bool smooth : {false, true}) {
            CAPTURE(warped);
            CAPTURE(smooth);
            CharacterInput input = underTube();
            if (warped) input.effects.set(BendWarpEffect{});
            if (smooth) {
                input.effects.set(SmoothJointsEffect{});
                input.basis = BasisChoice{BasisKind::Modes, 12};
                input = withResponses(std::move(input), false, 0);
            }
            auto c = Character::build(input).value();
            for (const Pose& pose : standardPoses(input.skeleton)) {
                c.update(pose);
                const auto stretch = stretchAtJoint(c);
                CHECK(stretch.over > 0.9);
                CHECK(stretch.over <= 1.2 * stretch.beside);
                worst = std::max(worst, stretch.over / stretch.beside);
            }
        }
    }
    MESSAGE("over the joint at most " << worst << " times as far as beside it");
}

TEST_CASE("render mesh: inside the bodies and farther from them, on coarse and fine ones, joints are passed as evenly") {
    double worst = 0.0;
    for (const double radius : {0.3, 0.45, 0.65})
        for (const int around : {6, 24}) {
            CAPTURE(radius);
            CAPTURE(around);
            CharacterInput input = two(around, around / 2);
            embedded::addRenderMesh(input, embedded::tube(radius, 0.05, 1.95, 48, 75), 1.0);
            auto c = Character::build(input).value();
            for (const Pose& pose : standardPoses(input.skeleton)) {
                c.update(pose);
                const auto stretch = stretchAtJoint(c);
                CHECK(stretch.over <= 1.2 * stretch.beside);
                worst = std::max(worst, stretch.over / stretch.beside);
            }
        }
    MESSAGE("over the joint at most " << worst << " times as far as beside it");
}

TEST_CASE("render mesh: where v does not say what a joint does, points beside it follow the body that is seen") {
    // Twist in the basis "paper", and elements without a response.
    for (const bool precomputed : {true, false}) {
        CAPTURE(precomputed);
        CharacterInput input = underTube();
        input.basis = BasisKind::Paper;
        input = withResponses(std::move(input), false, 0);
        if (!precomputed)
            for (auto& element : input.elements) element.response = nullptr;
        // On the surface of the first body, in the last row of its triangles.
        auto points = std::make_shared<EmbeddedPoints>();
        auto mesh = std::make_shared<EmbeddedMesh>();
        const auto& body = input.elements[0].mesh->body;
        std::vector<std::int32_t> triangles;
        for (std::int32_t t = 0; t < body.triangles.rows(); ++t) {
            int rim = 0;
            for (int k = 0; k < 3; ++k) rim += body.vertices(body.triangles(t, k), 2) == 1.0;
            if (rim == 1 || rim == 2) triangles.push_back(t);
        }
        points->rest.resize(static_cast<Eigen::Index>(triangles.size()), 3);
        const auto middle = [&](const Points& of, std::int32_t t) {
            return Eigen::RowVector3d((of.row(body.triangles(t, 0)) + of.row(body.triangles(t, 1)) + of.row(body.triangles(t, 2))) / 3.0);
        };
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            points->rest.row(static_cast<Eigen::Index>(i)) = middle(body.vertices, triangles[i]);
            mesh->vertices.push_back({0, static_cast<std::int32_t>(i), false});
        }
        input.elements[0].embedded = points;
        input.renderMeshes = {mesh};
        auto c = Character::build(input).value();
        const Pose pose = embedded::chainPose(input.skeleton, precomputed ? 0.0 : 0.5, precomputed ? 1.6 : 0.0, 1.0);
        c.update(pose);
        const Points now = c.positions(0), shown = positionsOf(c).cast<double>(), exact = c.renderPositions(0);
        double off = 0.0, moved = 0.0;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            off = std::max(off, (exact.row(row) - middle(now, triangles[i])).norm());
            for (int k = 0; k < 3; ++k) {
                const std::int32_t v = body.triangles(triangles[i], k);
                moved = std::max(moved, (now.row(v).transpose() - c.frame(0) * Vec3(body.vertices.row(v).transpose())).norm());
            }
        }
        CHECK((shown - exact).cwiseAbs().maxCoeff() < 1e-6);
        CHECK(moved > 0.1);
        CHECK(off < 0.02 * moved);  // gradients curve the surface between vertices a little
    }
}

TEST_CASE("render mesh: normals are unit and those of its triangles, over joints too, and hard edges of the file stay hard") {
    CharacterInput input = underTube();
    auto c = Character::build(input).value();
    const Points& rest = c.renderRestPositions(0);
    const auto check = [&](double cosine) {
        const Points now = positionsOf(c).cast<double>(), truth = vertexNormals({now, input.renderMeshes[0]->triangles});
        const Points shown = normalsOf(c).cast<double>();
        double worst = 1.0;
        for (Eigen::Index v = 0; v < rest.rows(); ++v) {
            CHECK(shown.row(v).norm() == doctest::Approx(1.0).epsilon(1e-5));
            if (v >= 48 && v < rest.rows() - 48) worst = std::min(worst, shown.row(v).dot(truth.row(v)));
        }
        MESSAGE("least cosine " << worst);
        CHECK(worst > cosine);
    };
    check(0.9999);
    for (const Pose& pose : standardPoses(input.skeleton)) {
        c.update(pose);
        check(0.97);
    }

    // A box with vertices of its own on every side, and one whose vertices are split for other reasons.
    for (const bool hard : {true, false}) {
        auto split = std::make_shared<EmbeddedMesh>();
        auto points = std::make_shared<EmbeddedPoints>();
        const auto box = shapes::box(Vec3(-0.6, -0.6, 0.2), Vec3(0.6, 0.6, 0.8), 2, 2, 2);
        const Points smooth = vertexNormals(box.mesh);
        const auto corners = static_cast<Eigen::Index>(box.mesh.triangles.size());
        points->rest.resize(corners, 3);
        split->normals.resize(corners, 3);
        split->triangles.resize(corners / 3, 3);
        for (Eigen::Index i = 0; i < corners; ++i) {
            const std::int32_t v = box.mesh.triangles.data()[i];
            points->rest.row(i) = box.mesh.vertices.row(v);
            const Vec3 facet = areaVector(box.mesh, static_cast<std::int32_t>(i / 3)).normalized();
            split->normals.row(i) = (hard ? facet.transpose() : Eigen::RowVector3d(smooth.row(v))).cast<float>();
            split->triangles.data()[i] = static_cast<std::int32_t>(i);
            split->vertices.push_back({0, static_cast<std::int32_t>(i), false});
        }
        CharacterInput boxed = two(8, 3);
        boxed.elements[0].embedded = points;
        boxed.renderMeshes = {split};
        auto b = Character::build(std::move(boxed)).value();
        CHECK((normalsOf(b) - split->normals).cwiseAbs().maxCoeff() < 1e-5f);
    }
}

TEST_CASE("render mesh: attached parts keep their shape and follow the body at their pivot") {
    CharacterInput input = underTube();
    auto points = std::make_shared<EmbeddedPoints>();
    const auto eye = shapes::sphere(0.1, 1);
    points->rest = eye.mesh.vertices.rowwise() + Eigen::RowVector3d(0.55, 0.0, 0.6);
    points->attached.push_back({Vec3(0.5, 0.0, 0.6), {}});
    auto mesh = std::make_shared<EmbeddedMesh>();
    mesh->triangles = eye.mesh.triangles;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(points->rest.rows()); ++i) {
        points->attached[0].points.push_back(i);
        mesh->vertices.push_back({0, i, false});
    }
    input.renderMeshes = {mesh};
    input.elements[0].embedded = points;
    for (const bool warped : {false, true}) {
        if (warped) input.effects.set(BendWarpEffect{});
        auto c = Character::build(input).value();
        for (const Pose& pose : standardPoses(input.skeleton)) {
            c.update(pose);
            const Points shown = positionsOf(c).cast<double>(), exact = c.renderPositions(0);
            double worst = 0.0;
            for (Eigen::Index a = 0; a < shown.rows(); ++a)
                for (Eigen::Index b = 0; b < a; ++b)
                    worst = std::max(worst, std::abs((shown.row(a) - shown.row(b)).norm() - (points->rest.row(a) - points->rest.row(b)).norm()));
            CHECK(worst < 1e-6);
            CHECK((shown - exact).cwiseAbs().maxCoeff() < 1e-5);
            // It stays at the surface.
            const auto body = c.surface(0);
            const float nearest = (Rows(body.positions, body.vertices, 3).rowwise() - positionsOf(c).colwise().mean()).rowwise().norm().minCoeff();
            CHECK(nearest < 0.2f);
        }
    }
}

TEST_CASE("render mesh: open, dense, two-sided, doubled, without triangles, far off and inside, everything stays finite") {
    std::mt19937 random(21);
    std::normal_distribution<double> d;
    for (int kind = 0; kind < 10; ++kind) {
        CAPTURE(kind);
        CharacterInput input = randomCharacter(random);
        const Points& body = input.elements[0].mesh->body.vertices;
        const double length = input.skeleton.points[1].z() - input.skeleton.points[0].z();
        TriangleMesh mesh = embedded::tube(0.52 * length, 0.0, length * static_cast<double>(input.elements.size()), 30, 40);
        mesh = unionOf(mesh, embedded::tube(0.1 * length, 0.0, length * static_cast<double>(input.elements.size()), 5, 12));  // insides
        mesh = unionOf(mesh, {body, input.elements[0].mesh->body.triangles});
        TriangleMesh soup;
        soup.vertices.resize(60, 3);
        for (Eigen::Index i = 0; i < soup.vertices.size(); ++i) soup.vertices.data()[i] = length * d(random);
        soup.triangles.resize(20, 3);
        for (std::int32_t i = 0; i < 60; ++i) soup.triangles.data()[i] = i < 30 ? i : i / 2;  // the last ones have no area
        mesh = unionOf(mesh, soup);
        embedded::addRenderMesh(input, mesh, length);
        auto c = Character::build(input).value();
        c.keepExact(true);
        Pose pose = restPose(input.skeleton);
        auto shown = Character::build(input).value();
        std::vector<double> numbers(static_cast<std::size_t>(c.shapeLayout().size()));
        std::uint64_t revision = c.renderSurface(0).revision;
        for (int frame = 0; frame < 10; ++frame) {
            wander(c, random, pose);
            if (input.effects.has<TouchEffect>()) {
                const Vec3 at = body.row(0).transpose();
                if (frame == 3) (void)setFinger(c, 0, 0, at, 0.8 * at, 0.0);
                if (frame == 7) liftFinger(c, 0, 0);
            }
            const auto asked = allocations();
            c.update(pose, 1.0 / 60.0);
            CHECK(allocations() == asked);
            CHECK(finite(c));
            CHECK(c.renderSurface(0).revision > revision);
            revision = c.renderSurface(0).revision;
            const Points exact = c.renderPositions(0);
            const double size = (exact.colwise().maxCoeff() - exact.colwise().minCoeff()).norm();
            CHECK((positionsOf(c).cast<double>() - exact).cwiseAbs().maxCoeff() < (c.formatError() + 1e-5) * size);
            // What takes keep shows the same bytes.
            c.shape(numbers.data());
            shown.show(numbers.data());
            CHECK(sameBytes(c, shown));
        }
    }
}

TEST_CASE("render mesh: nothing changes for a pose that stays") {
    auto c = Character::build(underTube()).value();
    const Pose pose = embedded::chainPose(c.input().skeleton, 0.5, 0.2, 1.1);
    c.update(pose);
    const auto before = c.renderSurface(0).revision;
    c.update(pose);
    CHECK(c.renderSurface(0).revision == before);
}

TEST_CASE("render mesh: dents are carried, and leave with the finger") {
    CharacterInput input = withResponses(underTube(), false, 12);
    input.effects.set(TouchEffect{});
    auto c = Character::build(input).value();
    const Pose pose = embedded::chainPose(input.skeleton, 0.7, 0.0, 1.0);
    c.update(pose, 1.0 / 60.0);
    const Points before = positionsOf(c).cast<double>();
    const Vec3 at(0.5, 0, 0.5), pressed = c.frame(0) * Vec3(0.35, 0, 0.5);
    REQUIRE(setFinger(c, 0, 0, at, pressed, 0.1));
    for (int frame = 0; frame < 120; ++frame) c.update(pose, 1.0 / 60.0);
    const Points dented = positionsOf(c).cast<double>();
    const auto body = c.surface(0);
    const Points bodyNow = Rows(body.positions, body.vertices, 3).cast<double>();
    // As deep as the body beside it.
    double deepest = 0.0, bodyDeepest = 0.0;
    deepest = (dented - before).rowwise().norm().maxCoeff();
    auto plain = Character::build(input).value();
    plain.update(pose, 1.0 / 60.0);
    const auto untouched = plain.surface(0);
    bodyDeepest = (bodyNow - Rows(untouched.positions, untouched.vertices, 3).cast<double>()).rowwise().norm().maxCoeff();
    CHECK(bodyDeepest > 0.02);
    CHECK(deepest > 0.5 * bodyDeepest);
    CHECK(deepest < 1.5 * bodyDeepest);
    liftFinger(c, 0, 0);
    for (int frame = 0; frame < 600 && !c.resting(); ++frame) c.update(pose, 1.0 / 60.0);
    c.update(pose, 1.0 / 60.0);
    CHECK(positionsOf(c).cast<double>() == before);
}

TEST_CASE("render mesh: the number of threads changes no byte") {
    for (const bool warped : {false, true}) {
        CharacterInput input = two(24, 12);
        embedded::addRenderMesh(input, embedded::tube(0.56, 0.02, 1.98, 100, 200), 1.0);
        input = withResponses(std::move(input), true, 8);
        input.effects.set(GravityEffect{});
        input.effects.set(TouchEffect{});
        if (warped) input.effects.set(BendWarpEffect{});
        auto one = Character::build(input).value();
        input.threads = 4;
        auto four = Character::build(input, {&one}).value();
        for (int frame = 0; frame < 8; ++frame) {
            const Pose pose = embedded::chainPose(input.skeleton, 0.1 * frame, 0.05 * frame, 1.0 + 0.02 * frame);
            for (Character* c : {&one, &four}) {
                if (frame == 3) (void)setFinger(*c, 0, 0, Vec3(0.5, 0, 0.5), Vec3(0.3, 0, 0.5), 0.1);
                c->update(pose, 1.0 / 60.0);
            }
            CHECK(sameBytes(one, four));
        }
    }
}

TEST_CASE("render mesh: the body under it is evaluated where it is needed, and by nobody else") {
    auto c = Character::build(underTube()).value();
    const auto& points = *c.input().elements[0].embedded;
    c.update(embedded::chainPose(c.input().skeleton, 0.3, 0.0, 1.0));
    CHECK(c.stats().evaluatedVertices == points.rest.rows() + c.input().elements[1].embedded->rest.rows());
    for (int e = 0; e < 2; ++e) CHECK(c.deformExternally(e, true));
    c.update(embedded::chainPose(c.input().skeleton, 0.4, 0.0, 1.0));
    CHECK(c.stats().evaluatedVertices == 0);
}

TEST_CASE("render mesh: an edit keeps the tables of what did not change") {
    CharacterInput input = underTube();
    auto c = Character::build(input).value();
    const Pose pose = embedded::chainPose(input.skeleton, 0.4, 0.1, 1.1);
    CharacterInput edited = input;
    edited.elements[1].response = std::make_shared<const ElementResponse>(*input.elements[1].response);
    auto again = Character::build(edited, {&c}).value(), anew = Character::build(edited).value();
    again.update(pose);
    anew.update(pose);
    CHECK(sameBytes(again, anew));
}

TEST_CASE("render mesh: input that contradicts itself is refused") {
    const CharacterInput good = underTube();
    const auto refused = [](const CharacterInput& input) {
        const auto made = Character::build(input);
        return !made && made.error().code == "bad-value";
    };
    const auto withPoints = [&](auto change) {
        CharacterInput input = good;
        auto points = std::make_shared<EmbeddedPoints>(*good.elements[0].embedded);
        change(*points);
        input.elements[0].embedded = points;
        return input;
    };
    const auto withMesh = [&](auto change) {
        CharacterInput input = good;
        auto mesh = std::make_shared<EmbeddedMesh>(*good.renderMeshes[0]);
        change(*mesh);
        input.renderMeshes[0] = mesh;
        return input;
    };
    CHECK_FALSE(refused(good));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.rest(0, 0) = std::numeric_limits<double>::infinity(); })));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.normals.conservativeResize(3, 3); })));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.bodyVertex[0] = 1 << 20; })));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.attached = {{Vec3::Zero(), {0, 0}}}; })));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.attached = {{Vec3::Zero(), {-1}}}; })));
    CHECK(refused(withPoints([](EmbeddedPoints& p) { p.rest.conservativeResize(5, 3), p.normals.resize(0, 3), p.bodyVertex.clear(); })));
    CHECK(refused(withMesh([](EmbeddedMesh& m) { m.vertices[0].element = 2; })));
    CHECK(refused(withMesh([](EmbeddedMesh& m) { m.vertices[0] = {0, 1 << 20, true}; })));
    CHECK(refused(withMesh([](EmbeddedMesh& m) { m.triangles(0, 0) = -1; })));
    CHECK(refused(withMesh([](EmbeddedMesh& m) { m.normals.resize(4, 3); })));
    CharacterInput missing = good;
    missing.renderMeshes.push_back(nullptr);
    CHECK(refused(missing));
    CharacterInput nothing = good;
    auto empty = std::make_shared<ElementMesh>();
    nothing.elements[0].mesh = empty;
    nothing.elements[0].faces.clear();
    nothing.elements[0].response = nullptr;
    nothing.joints.clear();
    nothing.elements[1].faces.clear();
    nothing.elements[1].response = nullptr;
    CHECK(refused(nothing));
}
