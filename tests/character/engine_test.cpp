// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <hwy/targets.h>
#include <numbers>
#include <random>

#include "core/character/normal_stencils.h"
#include "core/character/response_blocks.h"
#include "tests/character/caterpillar.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

constexpr ResponseFormat kFormats[] = {ResponseFormat::Float, ResponseFormat::Half, ResponseFormat::Int16};
constexpr AffineFloat kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

// Single precision: a few roundings of numbers as large as the element and its displacements.
constexpr double kSingle = 2e-6;

// What a format may get wrong, relative to the largest displacement. Half: entries have 11 bits, so each coordinate is within 2^-12 of the largest
// entry of a mode, and modes add up by chance. Int16: 2^-16, and as much again for weights of 16 bits, times the modes that add up.
double allowed(ResponseFormat format) { return format == ResponseFormat::Float ? kSingle : format == ResponseFormat::Half ? 6e-4 : 1.5e-4; }

Eigen::VectorXd randomNumbers(std::mt19937& random, Eigen::Index n) {
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    Eigen::VectorXd out(n);
    for (Eigen::Index i = 0; i < n; ++i) out[i] = d(random);
    return out;
}

// Positions by the kernels, for all vertices, those that are not free zero.
Points shown(ResponseBlocks& blocks, const Eigen::VectorXd& v, const std::vector<std::int32_t>& free, std::size_t vertices) {
    std::vector<float> positions(3 * (vertices + kVertexBlock), 0.0f);
    blocks.weigh(v);
    evaluateAndPlace(blocks.view(), blocks.weights(), kInPlace, 0, blocks.count(), nullptr, positions.data());
    Points out(static_cast<Eigen::Index>(free.size()), 3);
    for (std::size_t i = 0; i < free.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) out(static_cast<Eigen::Index>(i), axis) = positions[3 * static_cast<std::size_t>(free[i]) + axis];
    return out;
}

// A made-up element: points in a box with gaps in their numbering, and a response of smooth columns.
struct Made {
    Points vertices;
    std::vector<std::int32_t> free;
    Eigen::MatrixXd response;
    Made(int points, int columns, double size = 1.0) : vertices(points, 3) {
        std::mt19937 random(static_cast<unsigned>(points + columns));
        for (int i = 0; i < points; ++i) {
            vertices.row(i) = size * randomNumbers(random, 3).transpose();
            if (i % 7 != 3 && (i < 40 || i > 75)) free.push_back(i);
        }
        response.resize(3 * static_cast<Eigen::Index>(free.size()), columns);
        for (int c = 0; c < columns; ++c) {
            const Eigen::VectorXd k = 2.0 * randomNumbers(random, 9);
            for (std::size_t i = 0; i < free.size(); ++i) {
                const Vec3 p = vertices.row(free[i]).transpose() / size;
                for (int axis = 0; axis < 3; ++axis) response(3 * static_cast<Eigen::Index>(i) + axis, c) = std::pow(10.0, c % 5 - 2) * std::sin(k.segment<3>(3 * axis).dot(p) + c);
            }
        }
    }
    [[nodiscard]] double error(ResponseBlocks& blocks, const Eigen::VectorXd& v) const {
        const Eigen::VectorXd x = response * v;
        const Points u = Eigen::Map<const Points>(x.data(), response.rows() / 3, 3);
        Points wanted = u;
        for (std::size_t i = 0; i < free.size(); ++i) wanted.row(static_cast<Eigen::Index>(i)) += vertices.row(free[i]);
        return (shown(blocks, v, free, static_cast<std::size_t>(vertices.rows())) - wanted).rowwise().norm().maxCoeff() / u.rowwise().norm().maxCoeff();
    }
    // v that moves the body by about its size.
    [[nodiscard]] Eigen::VectorXd pose(std::mt19937& random) const {
        Eigen::VectorXd v = randomNumbers(random, response.cols());
        return v * (vertices.cwiseAbs().maxCoeff() / (response * v).cwiseAbs().maxCoeff());
    }
};

Points areaWeightedNormals(const Points& p, const std::vector<std::int32_t>& triangles) {
    Points n = Points::Zero(p.rows(), 3);
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const Vec3 a = p.row(triangles[t]).transpose(), b = p.row(triangles[t + 1]).transpose(), c = p.row(triangles[t + 2]).transpose();
        const Eigen::RowVector3d area = (b - a).cross(c - a).transpose();
        for (int i = 0; i < 3; ++i) n.row(triangles[t + i]) += area;
    }
    return n;
}

// Largest angle (radians) between the normals of stencils and those of triangles when `p` has moved to `now`.
double normalError(const Points& p, const Triangles& triangles, const Points& now, double scale) {
    const std::vector<std::int32_t> corners(triangles.data(), triangles.data() + triangles.size());
    const auto stencils = normalStencils(p, corners, scale);
    std::vector<float> positions(3 * stencils.size() + 4, 0.0f), normals(3 * stencils.size());
    for (Eigen::Index i = 0; i < now.size(); ++i) positions[static_cast<std::size_t>(i)] = static_cast<float>(now.data()[i]);
    findNormals(positions.data(), stencils.data(), static_cast<float>(scale), 0, static_cast<std::size_t>(p.rows()), normals.data());
    const Points wanted = areaWeightedNormals(now, corners);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < p.rows(); ++i) {
        const Vec3 n = Eigen::Map<const Eigen::Vector3f>(normals.data() + 3 * i).cast<double>(), w = wanted.row(i).transpose();
        CHECK(n.norm() == doctest::Approx(1.0).epsilon(1e-5));
        worst = std::max(worst, std::atan2(n.cross(w).norm(), n.dot(w)));
    }
    return worst;
}

// A caterpillar of large elements with made-up smooth responses: enough for threads.
CharacterInput largeCaterpillar() {
    caterpillar::Shape shape;
    shape.elements = 3;
    shape.around = {60};
    shape.along = {60};
    shape.precomputed = false;
    CharacterInput input = caterpillar::make(shape);
    for (auto& element : input.elements) {
        auto response = std::make_shared<ElementResponse>();
        response->firstColumn.push_back(0);
        const auto& vertices = element.mesh->body.vertices;
        std::vector<char> held(vertices.rows(), 0);
        for (const auto& face : element.faces) {
            response->bases.push_back(FaceBasis::on(element.mesh->body, face, BasisKind::Affine));
            response->firstColumn.push_back(response->firstColumn.back() + response->bases.back().columns());
            for (const auto v : face.vertices) held[v] = 1;
        }
        for (Eigen::Index v = 0; v < vertices.rows(); ++v)
            if (!held[v]) response->freeVertices.push_back(static_cast<std::int32_t>(v));
        response->response.resize(3 * static_cast<Eigen::Index>(response->freeVertices.size()), response->columns());
        for (Eigen::Index c = 0; c < response->response.cols(); ++c)
            for (std::size_t i = 0; i < response->freeVertices.size(); ++i) {
                const Vec3 p = vertices.row(response->freeVertices[i]).transpose();
                for (int axis = 0; axis < 3; ++axis) response->response(3 * static_cast<Eigen::Index>(i) + axis, c) = std::sin(p[(axis + c) % 3] * (c + 1) + axis);
            }
        response->stiffness = Eigen::MatrixXd::Zero(response->columns(), response->columns());
        element.response = response;
    }
    return input;
}

}  // namespace

TEST_CASE("engine: every format shows A' v within its error, with any number of columns") {
    std::mt19937 random(1);
    for (const int columns : {1, 2, 7, 12, 17, 33, 150})
        for (const auto format : kFormats) {
            const Made made(211, columns);
            ResponseBlocks blocks(made.vertices, made.free, Vec3::Zero(), made.response, format);
            CHECK(blocks.error() <= allowed(format));
            CHECK(blocks.error() > 0.0);
            for (int i = 0; i < 5; ++i) CHECK(made.error(blocks, made.pose(random)) <= 3 * allowed(format));  // strong and weak columns may cancel
            CHECK(made.error(blocks, 1e-6 * made.pose(random)) <= 3 * allowed(format) + 1e6 * kSingle);
        }
}

TEST_CASE("engine: bodies of any size keep their relative error") {
    std::mt19937 random(2);
    for (const double size : {1e-8, 1e-3, 1e8})
        for (const auto format : kFormats) {
            const Made made(100, 12, size);
            ResponseBlocks blocks(made.vertices, made.free, Vec3::Zero(), made.response, format);
            CHECK(blocks.error() <= allowed(format));
            CHECK(made.error(blocks, made.pose(random)) <= 3 * allowed(format));
        }
}

TEST_CASE("engine: no columns, no free vertices, and columns of zeros") {
    const Made made(100, 4);
    for (const auto format : kFormats) {
        ResponseBlocks none(made.vertices, {}, Vec3::Zero(), Eigen::MatrixXd(0, 4), format);
        none.weigh(Eigen::VectorXd::Ones(4));
        CHECK(none.count() == 0);
        CHECK(none.error() == 0.0);
        ResponseBlocks rigid(made.vertices, made.free, Vec3::Zero(), Eigen::MatrixXd(made.response.rows(), 0), format);
        const Points still = shown(rigid, Eigen::VectorXd(), made.free, 100);
        ResponseBlocks zeros(made.vertices, made.free, Vec3::Zero(), Eigen::MatrixXd::Zero(made.response.rows(), 4), format);
        CHECK(zeros.error() == 0.0);
        CHECK(zeros.modes() == 0);
        CHECK(shown(zeros, Eigen::VectorXd::Ones(4), made.free, 100) == still);
        for (std::size_t i = 0; i < made.free.size(); ++i)
            CHECK(still.row(static_cast<Eigen::Index>(i)) == made.vertices.row(made.free[i]).cast<float>().cast<double>());
    }
}

TEST_CASE("engine: affine motions of a whole element take no modes, flat elements included") {
    for (const bool flat : {false, true}) {
        Made made(300, 12);
        if (flat) made.vertices.col(2).setConstant(0.5);
        std::mt19937 random(3);
        for (Eigen::Index c = 0; c < 12; ++c) {
            const Eigen::VectorXd m = randomNumbers(random, 12);
            for (std::size_t i = 0; i < made.free.size(); ++i)
                made.response.block<3, 1>(3 * static_cast<Eigen::Index>(i), c) =
                    Eigen::Map<const Eigen::Matrix3d>(m.data()) * made.vertices.row(made.free[i]).transpose() + m.tail<3>();
        }
        for (const auto format : kFormats) {
            ResponseBlocks blocks(made.vertices, made.free, Vec3(0.1, 0.2, 0.3), made.response, format);
            CHECK(blocks.modes() == 0);
            CHECK(blocks.error() <= kSingle);
        }
    }
    // An elastic element between two parallel faces: six rigid motions and the stretch along its axis.
    caterpillar::Shape shape;
    shape.elements = 1;
    shape.tips = true;
    const auto input = caterpillar::make(shape);
    const auto& element = input.elements[0];
    const ResponseBlocks blocks(element.mesh->body.vertices, element.response->freeVertices, Vec3::Zero(), element.response->response, ResponseFormat::Float);
    CHECK(element.response->columns() == 18);
    CHECK(blocks.modes() == 11);
}

TEST_CASE("engine: vector instructions of every kind show the same") {
    std::mt19937 random(4);
    const Made made(211, 19);
    const Eigen::VectorXd v = made.pose(random);
    const auto body = caterpillar::make({}).elements[0].mesh->body;
    const auto choose = [](std::int64_t target) {  // 0: the best
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    };
    for (const auto format : kFormats) {
        ResponseBlocks blocks(made.vertices, made.free, Vec3::Zero(), made.response, format);
        const Points reference = shown(blocks, v, made.free, 211);
        for (const auto target : hwy::SupportedAndGeneratedTargets()) {
            choose(target);
            CHECK((shown(blocks, v, made.free, 211) - reference).cwiseAbs().maxCoeff() <= kSingle);
            CHECK(normalError(body.vertices, body.triangles, body.vertices, 1.0) < 1e-5);
            choose(0);
        }
    }
}

TEST_CASE("engine: normals are those of the triangles at rest and after affine motions, and nearly after smooth ones") {
    for (const double size : {1e-8, 1.0, 1e8}) {
        const auto bodies = {shapes::sphere(size, 4).mesh, shapes::torus(size, 0.3 * size, 60, 30).mesh, shapes::cylinder(size, 2 * size, 24, 12).mesh,
                             shapes::box(Vec3::Zero(), Vec3::Constant(size), 6, 6, 6).mesh};
        Eigen::Matrix3d shear = Eigen::Vector3d(1.0, 0.8, 1.3).asDiagonal();
        shear(0, 1) = 0.3;
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        for (const auto& mesh : bodies)
            for (const Eigen::Matrix3d& motion : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turn, shear})
                // Positions are rounded to a part of an edge, which a part of the third edge may double.
                CHECK(normalError(mesh.vertices, mesh.triangles, mesh.vertices * motion.transpose(), 1.0 / size) < 2e-4);
        // Twist: a ring of triangles sees rotations that differ by its size (0.13) times one radian per unit, and errors are of second order.
        const auto& torus = *(bodies.begin() + 1);
        Points now = torus.vertices;
        for (Eigen::Index i = 0; i < now.rows(); ++i) now.row(i) = (Eigen::AngleAxisd(now(i, 2) / size, Vec3::UnitZ()) * Vec3(now.row(i).transpose())).transpose();
        CHECK(normalError(torus.vertices, torus.triangles, now, 1.0 / size) < 0.13 * 0.13);
    }
}

TEST_CASE("engine: a vertex without triangles and triangles without area have some unit normal") {
    Points p(6, 3);
    p << 0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 1, 0, 0, 2, 0, 0;
    const std::vector<std::int32_t> triangles = {0, 1, 2, 0, 4, 5, 0, 2, 1};
    const auto stencils = normalStencils(p, triangles, 1.0);
    std::vector<float> positions(3 * stencils.size() + 4, 0.0f), normals(3 * stencils.size());
    for (Eigen::Index i = 0; i < p.size(); ++i) positions[static_cast<std::size_t>(i)] = static_cast<float>(p.data()[i]);
    findNormals(positions.data(), stencils.data(), 1.0f, 0, 6, normals.data());
    for (int v = 0; v < 6; ++v) CHECK(Eigen::Map<const Eigen::Vector3f>(normals.data() + 3 * v).norm() == doctest::Approx(1.0));
}

TEST_CASE("engine: the number of threads changes no byte, and frames with threads allocate nothing") {
    for (const auto format : kFormats) {
        std::vector<Character> characters;
        for (const int threads : {1, 3, 0}) {
            CharacterInput input = largeCaterpillar();
            input.format = format;
            input.threads = threads;
            characters.push_back(Character::build(std::move(input)).value());
        }
        Pose pose = restPose(characters[0].input().skeleton);
        for (int frame = 0; frame < 6; ++frame) {
            pose.points.back() += Vec3(0, 0, frame < 4 ? 0.02 : 0.0);
            for (auto& p : pose.points) p += Vec3(0.1, 0, 0);
            for (auto& c : characters) {
                const auto before = allocations();
                c.update(pose);
                CHECK(allocations() == before);
            }
            for (int e = 0; e < 3; ++e) {
                const auto a = characters[0].surface(e);
                for (const auto& c : characters) {
                    const auto b = c.surface(e);
                    CHECK(std::equal(a.positions, a.positions + 3 * a.vertices, b.positions));
                    CHECK(std::equal(a.normals, a.normals + 3 * a.vertices, b.normals));
                }
            }
        }
    }
}

TEST_CASE("engine: a character in any format stays beside the one in double precision, and says how near") {
    for (const auto format : kFormats) {
        caterpillar::Shape shape;
        shape.tips = true;
        CharacterInput input = caterpillar::make(shape);
        input.format = format;
        auto c = Character::build(std::move(input)).value();
        Pose pose = restPose(c.input().skeleton);
        for (int i = 1; i <= 20; ++i) c.solvePose({{0, Vec3::Zero()}, {5, Vec3(0.1 * i, 0.05 * i, 5)}}, pose);
        c.update(pose);
        for (int e = 0; e < 5; ++e) {
            CHECK(c.formatError(e) <= allowed(format));
            const auto& rest = c.input().elements[e].mesh->body.vertices;
            const Points local = ((c.positions(e).rowwise() - c.frame(e).translation().transpose()) * c.frame(e).linear()) - rest;
            const auto s = c.surface(e);
            const Points now = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(s.positions, s.vertices, 3).cast<double>();
            CHECK((now - c.positions(e)).rowwise().norm().maxCoeff() <= 2 * allowed(format) * local.rowwise().norm().maxCoeff() + 5 * kSingle);
        }
        CHECK(c.memory(2).response > 0);
        CHECK(c.memory(2).surface > 0);
    }
}

TEST_CASE("engine: a bent shape that only moves is evaluated once more, then moved as it is") {
    auto c = Character::build(caterpillar::make({})).value();
    Pose pose = restPose(c.input().skeleton);
    for (int i = 1; i <= 20; ++i) c.solvePose({{0, Vec3::Zero()}, {5, Vec3(0.1 * i, 0, 5)}}, pose);
    c.update(pose);
    const auto move = [&] {
        for (auto& p : pose.points) p += Vec3(0, 1, 0);
        c.update(pose);
    };
    move();
    const int once = c.stats().evaluatedElements;
    CHECK(once > 0);
    for (int i = 0; i < 3; ++i) {
        move();
        CHECK(c.stats().evaluatedElements == 0);
        for (int e = 0; e < 5; ++e) {
            const auto s = c.surface(e);
            const Points now = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(s.positions, s.vertices, 3).cast<double>();
            CHECK((now - c.positions(e)).cwiseAbs().maxCoeff() < 10 * kSingle);
        }
    }
}

TEST_CASE("engine: formats have names") {
    for (const auto format : kFormats) CHECK(responseFormat(formatName(format)).value() == format);
    CHECK(responseFormat("int8").error().code == "bad-value");
}
