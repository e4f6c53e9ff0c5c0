// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "core/mesh/bounds.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/winding_number.h"
#include "core/warp/bend_warp_tables.h"
#include "tests/support/allocations.h"
#include "tests/support/shapes.h"
#include "tests/warp/bent_bodies.h"

using namespace imomushi;
using namespace imomushi::warped;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kReference = IMOMUSHI_TEST_DATA "/reference/";

Element& rightHalf() {
    static Element e(between(readObj(kReference + "bend_cylinder_right.obj"), 0, 0.49, {SolverMeshSetting::Kind::Default, 0}));
    return e;
}

}  // namespace

TEST_CASE("bend warp: half of a cylinder bent by 45 and 75 degrees at its joint keeps its volume and its triangles") {
    auto& e = rightHalf();
    for (const auto& [angle, quality] : {std::pair{45.0, 0.70}, std::pair{75.0, 0.50}}) {
        const std::vector<FaceMotion> m{motion(e.input.faces[0], Vec3(0, 0, -angle * kDegree), Vec3::Zero()),
                                        motion(e.input.faces[1], Vec3::Zero(), Vec3::Zero())};
        const Points x = e.bend(m);
        CHECK(std::abs(enclosedVolume(x, e.body().triangles) / enclosedVolume(e.body().vertices, e.body().triangles) - 1.0) < 0.01);
        CHECK(worstQuality(e.body().vertices, x, e.body().triangles) >= quality);
        CHECK(selfIntersections({x, e.body().triangles}, 1).empty());
        // The neighbour is this half's mirror image beyond the plane of the joint.
        const Vec3 normal = m[0].rotation * Vec3(-1, 0, 0);
        for (const auto v : e.response->freeVertices) REQUIRE(normal.dot(x.row(v).transpose()) < 0.0);
    }
}

TEST_CASE("bend warp: 90 degrees of twist in half of a cylinder keep its volume and its triangles") {
    auto& e = rightHalf();
    const Points x = e.bend({motion(e.input.faces[0], Vec3(-45 * kDegree, 0, 0), Vec3::Zero()),
                             motion(e.input.faces[1], Vec3(45 * kDegree, 0, 0), Vec3::Zero())});
    CHECK(std::abs(enclosedVolume(x, e.body().triangles) / enclosedVolume(e.body().vertices, e.body().triangles) - 1.0) < 0.005);
    CHECK(worstQuality(e.body().vertices, x, e.body().triangles) >= 0.75);
}

TEST_CASE("bend warp: small motions give the linear response to second order") {
    auto& e = rightHalf();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (int pose = 0; pose < 3; ++pose) {
        Vec3 turn[2], shift[2];
        Eigen::Matrix3d stretch[2];
        for (int f = 0; f < 2; ++f) {
            turn[f] = Vec3(d(random), d(random), d(random)), shift[f] = Vec3(d(random), d(random), d(random));
            stretch[f].setZero();
            stretch[f](1, 1) = d(random), stretch[f](2, 2) = d(random), stretch[f](1, 2) = stretch[f](2, 1) = d(random);
        }
        std::vector<double> error;
        for (const double size : {0.04, 0.02, 0.01}) {
            std::vector<FaceMotion> m;
            for (int f = 0; f < 2; ++f)
                m.push_back(motion(e.input.faces[f], size * turn[f], size * shift[f], Eigen::Matrix3d::Identity() + size * stretch[f]));
            error.push_back((e.bend(m) - e.linear(m)).norm() / (e.linear(m) - e.body().vertices).norm());
        }
        // Relative errors fall like the size; rounding of single precision is far below.
        CHECK(error[0] / error[1] > 1.7);
        CHECK(error[1] / error[2] > 1.7);
        CHECK(error[2] < 0.05);
    }
}

TEST_CASE("bend warp: a rigid motion of all faces moves the body rigidly, also right round") {
    auto& e = rightHalf();
    for (const double angle : {0.0, 30.0, 179.0, 181.0, 300.0}) {
        const Vec3 turn = angle * kDegree * Vec3(1, 2, -1).normalized(), shift(3, 1, -2);
        const Eigen::Matrix3d r = Eigen::AngleAxisd(turn.norm(), Vec3(1, 2, -1).normalized()).toRotationMatrix();
        std::vector<FaceMotion> m;
        for (const auto& face : e.input.faces) {
            m.push_back(motion(face, turn, Vec3::Zero()));
            m.back().shift = shift;
        }
        const Points x = e.bend(m);
        CHECK(((x - e.body().vertices * r.transpose()).rowwise() - shift.transpose()).rowwise().norm().maxCoeff() < 2e-3);
    }
}

TEST_CASE("bend warp: a uniform stretch is uniform") {
    auto& e = rightHalf();
    const double s = 2.0, c = std::pow(s, -e.input.nu);
    const Eigen::Matrix3d across = Vec3(1, c, c).asDiagonal();
    const Points x = e.bend({motion(e.input.faces[0], Vec3::Zero(), Vec3::Zero(), across),
                             motion(e.input.faces[1], Vec3::Zero(), Vec3(4 * (s - 1), 0, 0), across)});
    const Eigen::Matrix3d all = Vec3(s, c, c).asDiagonal();
    CHECK((x - e.body().vertices * all).rowwise().norm().maxCoeff() < 0.01);
}

TEST_CASE("bend warp: shapes change smoothly as a twist passes half a turn") {
    auto& e = rightHalf();
    Points last;
    double largest = 0.0, smallest = 1e9;
    for (double angle = 150; angle <= 210; angle += 2) {
        const Points x = e.bend({motion(e.input.faces[0], Vec3(-angle * kDegree, 0.1, 0), Vec3::Zero()),
                                 motion(e.input.faces[1], Vec3(angle * kDegree, 0, 0.1), Vec3::Zero())});
        if (last.size() > 0) {
            const double step = (x - last).rowwise().norm().maxCoeff();
            largest = std::max(largest, step), smallest = std::min(smallest, step);
        }
        last = x;
    }
    CHECK(largest < 2.0 * smallest);
}

TEST_CASE("bend warp: a frame does not allocate and gives the same bytes again") {
    auto& e = rightHalf();
    const std::vector<FaceMotion> m{motion(e.input.faces[0], Vec3(0.3, 0.5, -1), Vec3(0.1, 0, 0)),
                                    motion(e.input.faces[1], Vec3(0, 1, 0), Vec3(0, 1, 0))};
    const Points held = e.heldPlaces(m);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(e.response->columns());
    e.warp->evaluate(m, none, held, e.local.data());
    const auto first = e.local;
    const auto before = allocations();
    e.warp->evaluate(m, none, held, e.local.data());
    CHECK(allocations() == before);
    CHECK(e.local == first);
}

namespace {

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh out;
    out.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    out.vertices << a.vertices, b.vertices;
    out.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    out.triangles << a.triangles, (b.triangles.array() + static_cast<std::int32_t>(a.vertices.rows())).matrix();
    return out;
}

// A made-up response: displacements of face vertices fall off with their distance. What evaluate() survives does not depend on a solver.
ElementResponse madeUp(const TriangleMesh& body, const std::vector<JointFace>& faces, BasisKind kind) {
    ElementResponse r;
    std::vector<char> held(static_cast<std::size_t>(body.vertices.rows()), 0);
    r.firstColumn.push_back(0);
    for (const auto& face : faces) {
        r.bases.push_back(FaceBasis::on(body, face, {kind}));
        r.firstColumn.push_back(r.firstColumn.back() + r.bases.back().columns());
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    }
    for (Eigen::Index v = 0; v < body.vertices.rows(); ++v)
        if (!held[static_cast<std::size_t>(v)]) r.freeVertices.push_back(static_cast<std::int32_t>(v));
    r.response = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(r.freeVertices.size()), r.columns());
    for (std::size_t i = 0; i < r.freeVertices.size(); ++i) {
        const Vec3 p = body.vertices.row(r.freeVertices[i]).transpose();
        double sum = 0.0;
        std::vector<double> near;
        for (const auto& face : faces) {
            near.push_back(1.0 / ((p - face.frame.origin).squaredNorm() + 1e-6));
            sum += near.back();
        }
        for (std::size_t f = 0; f < faces.size(); ++f)
            r.response.block(3 * static_cast<Eigen::Index>(i), r.firstColumn[f], 3, r.bases[f].columns()) =
                near[f] / sum * faces[f].frame.axes * r.bases[f].at(faces[f].frame.toLocal(p));
    }
    r.stiffness = Eigen::MatrixXd::Zero(r.columns(), r.columns());
    return r;
}

// Patches at the ends of the axes of a bumpy ball, flat or not.
std::vector<JointFace> patches(const TriangleMesh& body, int count, std::mt19937& random) {
    std::vector<JointFace> out;
    std::vector<char> used(static_cast<std::size_t>(body.vertices.rows()), 0);
    std::uniform_int_distribution<std::int32_t> pick(0, static_cast<std::int32_t>(body.triangles.rows()) - 1);
    for (int attempt = 0; attempt < 100 && static_cast<int>(out.size()) < count; ++attempt) {
        const auto face = jointFaceBySeed(body, EdgeTable(body.triangles), pick(random), 0.6, 0.2);
        if (!face) continue;
        bool free = true;
        for (const auto v : face->vertices) free = free && !used[static_cast<std::size_t>(v)];
        if (!free) continue;
        for (const auto v : face->vertices) used[static_cast<std::size_t>(v)] = 1;
        out.push_back(*face);
    }
    return out;
}

}  // namespace

TEST_CASE("bend warp: any motion of any faces of any body gives finite shapes") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (int round = 0; round < 60; ++round) {
        TriangleMesh body = shapes::sphere(1.0, 1 + round % 3).mesh;
        for (Eigen::Index v = 0; v < body.vertices.rows(); ++v) body.vertices.row(v) *= 1.0 + 0.1 * d(random);
        if (round % 4 == 1) body = together(body, shapes::sphere(0.4, 1).mesh);  // a second shell
        if (round % 4 == 2) body.vertices.row(3) = body.vertices.row(4);         // slivers and a lost vertex
        if (round % 4 == 3) body.vertices.col(2) *= 1e-6;
        if (round % 5 == 0) body.vertices *= round % 2 ? 1e7 : 1e-7;
        const double size = body.vertices.rowwise().norm().maxCoeff();
        const auto faces = round % 5 == 0 ? std::vector<JointFace>{} : patches(body, 1 + round % 8, random);
        const auto response = madeUp(body, faces, round % 3 ? BasisKind::Affine : BasisKind::Paper);
        std::vector<std::int32_t> blocks;
        for (const auto v : response.freeVertices)
            if (blocks.empty() || v >= blocks.back() + BendWarp::kBlock) blocks.push_back(v);
        auto warp = BendWarp::build(body, faces, response, 0.49, blocks, Vec3::Zero(), {});
        REQUIRE(warp.has_value());
        std::vector<float> local(3 * BendWarp::kBlock * blocks.size(), 0.0f);
        for (int pose = 0; pose < 20; ++pose) {
            std::vector<FaceMotion> motions;
            for (const auto& face : faces) {
                Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
                for (int i = 0; i < 3; ++i) stretch(i, i) = std::pow(10.0, d(random)) * (pose % 5 == 4 && d(random) < 0 ? -1.0 : 1.0);
                if (pose % 7 == 6) stretch.setZero();
                motions.push_back(motion(face, 2.0 * std::numbers::pi * Vec3(d(random), d(random), d(random)),
                                         std::pow(10.0, 2 * d(random)) * size * Vec3(d(random), d(random), d(random)), stretch));
                if (pose % 9 == 8) motions.back() = motion(face, Vec3::Zero(), -face.frame.origin);  // all faces in one place
            }
            Points held(static_cast<Eigen::Index>(warp->heldVertices().size()), 3);
            Eigen::Index row = 0;
            for (std::size_t f = 0; f < faces.size(); ++f)
                for (const auto v : faces[f].vertices)
                    held.row(row++) = (motions[f].linear * body.vertices.row(v).transpose() + motions[f].shift).transpose();
            warp->evaluate(motions, Eigen::VectorXd::Zero(response.columns()), held, local.data());
            for (const float x : local) REQUIRE(std::isfinite(x));
        }
    }
}

TEST_CASE("bend warp: a body without faces stays at rest, and a cavity moves with its body") {
    const auto outer = shapes::cylinder(1.0, 4.0, 16, 16);
    TriangleMesh inner = shapes::sphere(0.3, 2).mesh;
    inner.triangles.col(1).swap(inner.triangles.col(2));
    inner.vertices.col(2).array() += 2.0;
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = together(outer.mesh, inner);
    Element e(between(mesh, 2, 0.49));
    const Points rest = e.bend({FaceMotion{}, FaceMotion{}});
    CHECK((rest - mesh->body.vertices).cwiseAbs().maxCoeff() < 1e-5);
    const Points x =
        e.bend({motion(e.input.faces[0], Vec3(0.6, 0, 0), Vec3::Zero()), motion(e.input.faces[1], Vec3(-0.6, 0, 0), Vec3::Zero())});
    CHECK(selfIntersections({x, mesh->body.triangles}, 1).empty());
    std::vector<std::int32_t> triangles(static_cast<std::size_t>(outer.mesh.triangles.rows()));
    std::iota(triangles.begin(), triangles.end(), 0);
    for (auto v = outer.mesh.vertices.rows(); v < x.rows(); ++v)
        CHECK(windingNumber({x, mesh->body.triangles}, triangles, x.row(v).transpose()) > 0.5);
}

TEST_CASE("bend warp: a large body is carried by a coarse one, within 1 per mille of the warp of all its vertices, and in any pieces with the same bytes") {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = shapes::cylinder(1.0, 4.0, 110, 100).mesh;
    const auto in = between(mesh, 2, 0.49, {SolverMeshSetting::Kind::Decimated, 500});
    Element e(in);
    REQUIRE(e.warp->carried() == e.response->freeVertices.size());
    auto exact = std::make_unique<BendWarp>(BendWarpTables::buildWhole(e.body(), in.faces, *e.response, in.nu, e.blocks, Vec3::Zero(), {}).value());
    REQUIRE(exact->carried() == 0);
    const double size = diagonalOf(e.body().vertices);
    CHECK((e.bend({FaceMotion{}, FaceMotion{}}) - e.body().vertices).cwiseAbs().maxCoeff() < 1e-5 * size);
    for (const double angle : {30.0, 90.0}) {
        const double a = angle * std::numbers::pi / 360.0;
        const std::vector<FaceMotion> m{motion(in.faces[0], Vec3(a, 0, 0), Vec3::Zero()), motion(in.faces[1], Vec3(-a, 0, 0), Vec3::Zero())};
        const Points carried = e.bend(m);
        const auto once = e.local;
        const Points held = e.heldPlaces(m);
        e.warp->solve(m, Eigen::VectorXd::Zero(e.response->columns()), held, e.local.data());
        for (std::size_t i = e.warp->carried(); i > 0;) {
            const std::size_t begin = i - std::min<std::size_t>(i, 777);
            e.warp->carry(begin, i, e.local.data());
            i = begin;
        }
        CHECK(e.local == once);
        std::swap(e.warp, exact);
        const Points solved = e.bend(m);
        std::swap(e.warp, exact);
        const double distance = (carried - solved).rowwise().norm().maxCoeff() / size;
        CAPTURE(angle);
        MESSAGE("carried " << angle << " degrees: " << 1e3 * distance << " per mille from the whole warp");
        CHECK(distance < 1e-3);
    }
}

TEST_CASE("bend warp: a response of another body is refused") {
    auto& e = rightHalf();
    auto other = e.body();
    other.vertices.conservativeResize(other.vertices.rows() - 1, 3);
    CHECK(BendWarp::build(other, e.input.faces, *e.response, 0.49, e.blocks, Vec3::Zero(), {}).error().code == "bad-value");
    CHECK(BendWarp::build(e.body(), {e.input.faces[0]}, *e.response, 0.49, e.blocks, Vec3::Zero(), {}).error().code == "bad-value");
    CHECK(BendWarp::build(e.body(), e.input.faces, *e.response, 0.49, {}, Vec3::Zero(), {}).error().code == "bad-value");
    std::stop_source stop;
    stop.request_stop();
    CHECK(
        BendWarp::build(e.body(), e.input.faces, *e.response, 0.49, e.blocks, Vec3::Zero(), Progress({}, stop.get_token())).error().code ==
        kCancelled);
}
