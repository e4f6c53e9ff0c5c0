// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/meshing/appendages.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stop_token>

#include "core/mesh/health.h"
#include "core/reduction/element_response.h"
#include "tests/support/voxels.h"

using namespace imomushi;
using shapes::block;
using shapes::operator+;
using shapes::Voxels;

namespace {

constexpr double kSide = 0.25;

/// A bar of 1 x 1 x 3 m with faces at z = 0 and z = 3, and what grows from it.
const Voxels kBar = block({0, 0, 0}, {4, 4, 12});
const Voxels kHorn = block({1, 4, 5}, {2, 10, 6});  // 1.5 m on the side y = 1, 0.25 m wide
const Voxels kForked = block({1, 4, 5}, {2, 8, 6}) + block({0, 8, 5}, {3, 9, 6}) + block({0, 9, 5}, {1, 13, 6}) + block({2, 9, 5}, {3, 13, 6});

const Voxels kTwo = block({1, 4, 2}, {2, 10, 3}) + block({1, 4, 9}, {2, 10, 10});

struct Body {
    TriangleMesh mesh;
    std::vector<JointFace> faces;
};

std::vector<std::int32_t> verticesIn(const TriangleMesh& mesh, const std::function<bool(const Vec3&)>& inside) {
    return shapes::patchWhere(mesh, inside).vertices;
}

Body bodyOf(const Voxels& voxels, const std::vector<std::function<bool(const Vec3&)>>& faces) {
    Body out{shapes::surfaceOf(voxels, kSide), {}};
    for (const auto& face : faces) out.faces.push_back(jointFaceByVertices(out.mesh, verticesIn(out.mesh, face)).value());
    return out;
}
bool atLow(const Vec3& x) { return x.z() < 1e-9; }
bool atHigh(const Vec3& x) { return x.z() > 3.0 - 1e-9; }
Body barWith(const Voxels& more) { return bodyOf(kBar + more, {atLow, atHigh}); }

TrimmedBody trim(const Body& body) {
    auto out = withoutAppendages({body.mesh, {}}, body.faces, {});
    REQUIRE(out);
    return std::move(*out);
}

void checkAsItIs(const Body& body) {
    const TrimmedBody trimmed = trim(body);
    CHECK(trimmed.appendages.empty());
    CHECK(trimmed.mesh.vertices == body.mesh.vertices);
    CHECK(trimmed.mesh.triangles == body.mesh.triangles);
    for (std::size_t f = 0; f < body.faces.size(); ++f) CHECK(trimmed.faces[f].vertices == body.faces[f].vertices);
}

/// Of a closed surface; 2 for a sphere.
Eigen::Index eulerOf(const TriangleMesh& mesh) { return mesh.vertices.rows() - mesh.triangles.rows() / 2; }

/// Closed, outward, every body vertex either kept in its place or dropped, faces those of the body.
void checkTrimmed(const Body& body, const TrimmedBody& trimmed) {
    const MeshFacts facts = meshFacts(trimmed.mesh);
    CHECK(facts.closed);
    CHECK(facts.outward);
    CHECK(facts.components == 1);
    CHECK(eulerOf(trimmed.mesh) == eulerOf(body.mesh));
    std::vector<int> seen(static_cast<std::size_t>(body.mesh.vertices.rows()));
    for (std::size_t v = 0; v < trimmed.bodyVertex.size(); ++v) {
        if (trimmed.bodyVertex[v] < 0) continue;
        ++seen[static_cast<std::size_t>(trimmed.bodyVertex[v])];
        CHECK(trimmed.mesh.vertices.row(static_cast<Eigen::Index>(v)) == body.mesh.vertices.row(trimmed.bodyVertex[v]));
    }
    for (const auto& one : trimmed.appendages) {
        CHECK(std::is_sorted(one.dropped.begin(), one.dropped.end()));
        for (const std::int32_t v : one.dropped) ++seen[static_cast<std::size_t>(v)];
    }
    CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        REQUIRE(trimmed.faces[f].vertices.size() == body.faces[f].vertices.size());
        for (std::size_t i = 0; i < body.faces[f].vertices.size(); ++i) CHECK(trimmed.bodyVertex[static_cast<std::size_t>(trimmed.faces[f].vertices[i])] == body.faces[f].vertices[i]);
        for (const std::int32_t t : trimmed.faces[f].triangles)
            for (int c = 0; c < 3; ++c) CHECK(std::binary_search(trimmed.faces[f].vertices.begin(), trimmed.faces[f].vertices.end(), trimmed.mesh.triangles(t, c)));
    }
}

/// x -> shift + turn cross x at the rows of `points`, in one column.
Eigen::MatrixXd rigid(const Points& points, const Vec3& shift, const Vec3& turn) {
    Eigen::MatrixXd out(points.size(), 1);
    for (Eigen::Index v = 0; v < points.rows(); ++v) out.block<3, 1>(3 * v, 0) = shift + turn.cross(Vec3(points.row(v).transpose()));
    return out;
}

}  // namespace

TEST_CASE("appendages: a body without any is returned as it is") {
    checkAsItIs(barWith({}));
    checkAsItIs(barWith(block({1, 4, 5}, {2, 5, 6})));            // a wart
    checkAsItIs(bodyOf(block({0, 0, 0}, {4, 4, 4}), {atLow}));    // a cube on one face
    checkAsItIs({barWith(kHorn).mesh, {}});                       // no joint face: rigid anyway
}

TEST_CASE("appendages: a horn is cut off about a width above its foot, a fork in one piece, two horns in two") {
    for (const Voxels& voxels : {kHorn, kForked, kTwo}) {
        const Body body = barWith(voxels);
        const TrimmedBody trimmed = trim(body);
        checkTrimmed(body, trimmed);
        REQUIRE(trimmed.appendages.size() == (voxels == kTwo ? 2 : 1));
        for (const auto& one : trimmed.appendages) {
            // Four sides of 0.25 m; the loop one or two rings of squares above the foot at y = 1.
            CHECK(one.width == doctest::Approx(4.0 * kSide / std::numbers::pi));
            for (std::size_t i = 0; i + 1 < one.support.size(); ++i) {
                const double y = trimmed.mesh.vertices(one.support[i], 1);
                CHECK(y > 1.0 + 0.5 * kSide);
                CHECK(y < 1.0 + 2.5 * kSide);
            }
        }
        CHECK(meshFacts(trimmed.mesh).volume < meshFacts(body.mesh).volume);
    }
}

TEST_CASE("appendages: neither a handle, nor a leg that leads to a joint face, nor a band around the body is one") {
    checkAsItIs(barWith(kTwo + block({1, 9, 2}, {2, 10, 10})));
    const double tip = 10.0 * kSide - 1e-9;
    checkAsItIs(bodyOf(kBar + kHorn, {atLow, atHigh, [tip](const Vec3& x) { return x.y() > tip; }}));
    checkAsItIs(barWith(block({-1, -1, 5}, {5, 5, 7})));
}

TEST_CASE("appendages: bodies of several shells are left as they are") {
    Voxels hollow = kBar + kHorn;
    hollow.erase({1, 1, 5});  // a cavity
    checkAsItIs(bodyOf(hollow, {atLow, atHigh}));
}

TEST_CASE("appendages: the far part of a long tail with one joint face is one, and begins two widths from the face") {
    const Body body = bodyOf(block({0, 0, 0}, {2, 2, 12}), {atLow});
    const TrimmedBody trimmed = trim(body);
    checkTrimmed(body, trimmed);
    REQUIRE(trimmed.appendages.size() == 1);
    const auto& one = trimmed.appendages[0];
    CHECK(trimmed.mesh.vertices(one.support[0], 2) >= 1.5 * one.width);
    CHECK(trimmed.mesh.vertices(one.support[0], 2) <= 2.5 * one.width);
}

TEST_CASE("appendages: the same in any unit, place and order of vertices") {
    const Body body = barWith(kForked);
    const TrimmedBody plain = trim(body);
    REQUIRE(plain.appendages.size() == 1);
    const auto dropped = [&](const TriangleMesh& mesh) {
        Body other{mesh, {}};
        for (const JointFace& face : body.faces) {
            other.faces.push_back(face);
            if (mesh.triangles == body.mesh.triangles) continue;
            for (std::int32_t& v : other.faces.back().vertices) v = static_cast<std::int32_t>(mesh.vertices.rows()) - 1 - v;
            std::reverse(other.faces.back().vertices.begin(), other.faces.back().vertices.end());
        }
        return trim(other).appendages.at(0).dropped;
    };
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
    for (const double scale : {1e-6, 1.0, 1e6}) {
        TriangleMesh moved = body.mesh;
        moved.vertices = scale * ((body.mesh.vertices * turn.transpose()).rowwise() + Eigen::RowVector3d(300.0, -20.0, 7.0));
        CHECK(dropped(moved) == plain.appendages[0].dropped);
    }
    TriangleMesh reversed = body.mesh;
    reversed.vertices = body.mesh.vertices.colwise().reverse().eval();
    reversed.triangles = (static_cast<std::int32_t>(body.mesh.vertices.rows()) - 1 - body.mesh.triangles.array()).matrix();
    std::vector<std::int32_t> back = dropped(reversed);
    for (std::int32_t& v : back) v = static_cast<std::int32_t>(body.mesh.vertices.rows()) - 1 - v;
    std::reverse(back.begin(), back.end());
    CHECK(back == plain.appendages[0].dropped);
}

TEST_CASE("appendages: what is dropped follows rigid motions exactly, and starts where its cut is") {
    const Body body = barWith(kForked);
    const TrimmedBody trimmed = trim(body);
    const Vec3 shift(0.3, -0.2, 0.5), turn(0.1, 0.7, -0.4);
    const Eigen::MatrixXd followed = trimmed.onBody(body.mesh.vertices, rigid(trimmed.mesh.vertices, shift, turn));
    CHECK((followed - rigid(body.mesh.vertices, shift, turn)).cwiseAbs().maxCoeff() <= 1e-13 * 5.0);

    // A twist about the horn's axis: near the cut it goes on, at the tips only its rigid part is left, nothing.
    const auto twist = [](const Points& points) {
        Eigen::MatrixXd out(points.size(), 1);
        for (Eigen::Index v = 0; v < points.rows(); ++v) {
            const double x = points(v, 0) - 0.375, z = points(v, 2) - 1.375;
            out.block<3, 1>(3 * v, 0) = Vec3(x * z, 0.0, 0.0);
        }
        return out;
    };
    const Eigen::MatrixXd strained = trimmed.onBody(body.mesh.vertices, twist(trimmed.mesh.vertices));
    const double atCut = std::pow(0.5 * kSide, 2);
    for (const std::int32_t v : trimmed.appendages[0].dropped) {
        CHECK(strained.block<3, 1>(3 * v, 0).norm() <= atCut);
        if (body.mesh.vertices(v, 1) > 2.5) CHECK(strained.block<3, 1>(3 * v, 0).norm() <= 0.01 * atCut);
    }
}

TEST_CASE("appendages: finding them is cancelled") {
    const Body body = barWith(kHorn);
    std::stop_source stop;
    stop.request_stop();
    const auto trimmed = withoutAppendages({body.mesh, {}}, body.faces, Progress({}, stop.get_token()));
    REQUIRE(!trimmed);
    CHECK(trimmed.error().code == "cancelled");
}

TEST_CASE("element with a horn: rigid motions are exact on every solver mesh, alone and with loads, and the whole weight hangs on the faces") {
    const Body body = barWith(kForked);
    ResponseInput input;
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body.mesh;
    input.mesh = mesh;
    input.faces = body.faces;
    const Vec3 shift(0.3, -0.2, 0.5), turn(0.1, 0.7, -0.4);
    for (const char* solverMesh : {"as-is", "refined:600", "decimated:150", "default"})
        for (const BasisKind basis : {BasisKind::Affine, BasisKind::Full}) {
            CAPTURE(solverMesh);
            input.solverMesh = parseSolverMesh(solverMesh).value();
            input.basis = basis;
            input.loads = basis == BasisKind::Affine && input.solverMesh.kind == SolverMeshSetting::Kind::AsIs ? BodyLoads::Always : BodyLoads::None;
            const auto response = buildResponse(input, {});
            REQUIRE(response);
            CHECK(3 * static_cast<Eigen::Index>(response->freeVertices.size()) == response->response.rows());
            const Eigen::MatrixXd wanted = rigid(body.mesh.vertices, shift, turn);
            Eigen::VectorXd v = Eigen::VectorXd::Zero(response->columns());
            for (std::size_t f = 0; f < input.faces.size(); ++f) {
                const JointFace& face = input.faces[f];
                if (basis == BasisKind::Full) {
                    for (std::size_t i = 0; i < face.vertices.size(); ++i)
                        v.segment<3>(response->firstColumn[f] + 3 * static_cast<Eigen::Index>(i)) = face.frame.axes.transpose() * wanted.block<3, 1>(3 * face.vertices[i], 0);
                    continue;
                }
                JointMap map;
                map.shift = face.frame.axes.transpose() * (shift + turn.cross(face.frame.origin));
                const Vec3 local = face.frame.axes.transpose() * turn;
                for (int axis = 0; axis < 3; ++axis) map.linear.col(axis) += local.cross(Vec3::Unit(axis));
                double lost = 0.0;
                response->bases[f].coefficients(map, face.size, v.data() + response->firstColumn[f], lost);
                CHECK(lost <= 1e-12);
            }
            const Eigen::VectorXd u = response->response * v;
            double worst = 0.0;
            for (std::size_t i = 0; i < response->freeVertices.size(); ++i)
                worst = std::max(worst, (u.segment<3>(3 * static_cast<Eigen::Index>(i)) - wanted.block<3, 1>(3 * response->freeVertices[i], 0)).norm());
            CHECK(worst <= 1e-8);  // of metres; the equations of quadratic displacement are refined to 1e-10
            CHECK((response->stiffness * v).norm() <= 1e-9 * response->stiffness.norm());
            if (input.loads == BodyLoads::None) continue;
            // Along a rigid shift the forces of the faces take up the weight of the body, the horn's included.
            REQUIRE(response->loads.rows() == response->response.rows());
            Eigen::VectorXd along = Eigen::VectorXd::Zero(response->columns());
            for (std::size_t f = 0; f < input.faces.size(); ++f) {
                JointMap map;
                map.shift = input.faces[f].frame.axes.transpose() * Vec3::UnitX();
                double lost = 0.0;
                response->bases[f].coefficients(map, input.faces[f].size, along.data() + response->firstColumn[f], lost);
            }
            CHECK(along.dot(response->loadForces.col(0)) == doctest::Approx(-meshFacts(body.mesh).volume).epsilon(1e-9));
        }
}

TEST_CASE("body loads where they are cheap: as if they were always asked for, but for none on a body with an appendage") {
    for (const Voxels& more : {Voxels{}, kHorn}) {
        const Body body = barWith(more);
        ResponseInput input;
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = body.mesh;
        input.mesh = mesh;
        input.faces = body.faces;
        for (const bool tetrahedra : {false, true}) {
            CAPTURE(tetrahedra);
            input.solverMesh = parseSolverMesh(tetrahedra ? "draft" : "as-is").value();
            const auto with = [&](BodyLoads loads) {
                input.loads = loads;
                auto response = buildResponse(input, {});
                REQUIRE(response);
                return std::move(*response);
            };
            const ElementResponse none = with(BodyLoads::None), cheap = with(BodyLoads::WhereCheap), always = with(BodyLoads::Always);
            CHECK(none.loads.size() == 0);
            CHECK(always.loads.rows() == none.response.rows());
            CHECK(bool(cheap.response == always.response));
            CHECK(bool(cheap.stiffness == always.stiffness));
            CHECK((cheap.response - none.response).norm() <= 1e-12 * none.response.norm());  // products of more columns round otherwise
            if (more.empty()) CHECK(bool(cheap.loads == always.loads));
            else CHECK(cheap.loads.size() == 0);
        }
    }
}
