// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/topology.h"
#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

ResponseInput fullInput(const shapes::Body& body, BasisKind basis, double nu = 0.4, const char* solverMesh = "default") {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const auto& end : body.ends) {
        auto face = jointFaceByVertices(body.mesh, end.vertices);
        REQUIRE(face);
        input.faces.push_back(*face);
    }
    input.basis = basis;
    input.nu = nu;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    return input;
}

shapes::Body oblique(int around = 12, int along = 6) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    return shapes::moved(shapes::cylinder(0.5, 2.0, around, along), turn, Vec3(3, -1, 2));
}

/// Joint parameters of the full basis that each one of the affine basis is: 3 m x g.
Eigen::MatrixXd affineModes(const ResponseInput& input, const ElementResponse& full, const ElementResponse& affine) {
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(full.columns(), affine.columns());
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        const Points rest = localVertices(input.mesh->body, input.faces[f]);
        for (Eigen::Index i = 0; i < rest.rows(); ++i)
            C.block(full.firstColumn[f] + 3 * i, affine.firstColumn[f], 3, affine.bases[f].columns()) = affine.bases[f].at(rest.row(i).transpose());
    }
    return C;
}

/// Columns: the six rigid motions of the faces, in face axes, about the origin.
Eigen::MatrixXd rigidMotions(const ResponseInput& input, const ElementResponse& full) {
    Eigen::MatrixXd R(full.columns(), 6);
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i) {
            const Vec3 p = input.mesh->body.vertices.row(input.faces[f].vertices[i]).transpose();
            const Eigen::Index row = full.firstColumn[f] + 3 * static_cast<Eigen::Index>(i);
            for (int axis = 0; axis < 3; ++axis) {
                R.block<3, 1>(row, axis) = input.faces[f].frame.axes.transpose() * Vec3::Unit(axis);
                R.block<3, 1>(row, 3 + axis) = input.faces[f].frame.axes.transpose() * Vec3::Unit(axis).cross(p);
            }
        }
    return R;
}

}  // namespace

TEST_CASE("full basis: what the affine basis says is part of it, to rounding") {
    for (const char* mesh : {"as-is", "default", "refined:400"}) {
        CAPTURE(mesh);
        const ResponseInput input = fullInput(oblique(), BasisKind::Full, 0.4, mesh), reduced = fullInput(oblique(), BasisKind::Affine, 0.4, mesh);
        const auto full = buildResponse(input, {}), affine = buildResponse(reduced, {});
        REQUIRE(full);
        REQUIRE(affine);
        CHECK(full->columns() == 3 * static_cast<int>(input.faces[0].vertices.size() + input.faces[1].vertices.size()));
        const Eigen::MatrixXd C = affineModes(input, *full, *affine);
        CHECK((full->response * C - affine->response).norm() <= 1e-10 * affine->response.norm());
        CHECK(full->quality.error == doctest::Approx(affine->quality.error).epsilon(1e-6));
        MESSAGE(std::string(mesh) << ": full " << full->columns() << " columns, asymmetry " << full->quality.asymmetry << ", negative energy "
                     << full->quality.negativeEnergy << ", " << full->quality.seconds << " s, " << full->bytes() << " bytes; affine asymmetry "
                     << affine->quality.asymmetry << ", " << affine->quality.seconds << " s, " << affine->bytes() << " bytes");
        // Before it is made symmetric K would be the same too.
        CHECK((C.transpose() * full->stiffness * C - affine->stiffness).norm() <= 0.05 * affine->stiffness.norm());
    }
}

TEST_CASE("full basis: the stiffness is symmetric, without negative energy, and zero on exactly the rigid motions") {
    const ResponseInput input = fullInput(oblique(), BasisKind::Full);
    const auto full = buildResponse(input, {});
    REQUIRE(full);
    const Eigen::MatrixXd& K = full->stiffness;
    CHECK(K == K.transpose());
    const Eigen::MatrixXd R = rigidMotions(input, *full);
    CHECK((K * R).norm() <= 1e-11 * K.norm() * R.norm());
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    CHECK(values[0] >= -1e-12 * values[K.rows() - 1]);
    MESSAGE("eigenvalues " << values[0] << " ... " << values[5] << " | " << values[6] << " ... " << values[K.rows() - 1]);
    CHECK(values[5] <= 1e-12 * values[K.rows() - 1]);
    CHECK(values[6] >= 1e-6 * values[K.rows() - 1]);
}

TEST_CASE("full basis: the tractions balance, and are those of a bar under tension") {
    const ResponseInput input = fullInput(shapes::bar(3), BasisKind::Full, 0.3);
    const auto full = buildResponse(input, {});
    REQUIRE(full);
    const Eigen::MatrixXd& T = full->tractions;
    REQUIRE(T.rows() == full->columns());
    // u = (-nu x, -nu y, z): sigma_zz = E = 2 (1 + nu), the faces' normals are -z and z.
    Eigen::VectorXd v(full->columns());
    for (std::size_t f = 0; f < 2; ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i) {
            const Vec3 p = input.mesh->body.vertices.row(input.faces[f].vertices[i]).transpose();
            v.segment<3>(full->firstColumn[f] + 3 * static_cast<Eigen::Index>(i)) =
                input.faces[f].frame.axes.transpose() * Vec3(-0.3 * p.x(), -0.3 * p.y(), p.z());
        }
    const Eigen::VectorXd t = T * v;
    for (std::size_t f = 0; f < 2; ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i)
            CHECK((t.segment<3>(full->firstColumn[f] + 3 * static_cast<Eigen::Index>(i)) - Vec3(0, 0, f == 0 ? -2.6 : 2.6)).norm() <= 1e-8);
    // Any displacement: no force and no moment is left.
    std::srand(3);
    const Eigen::VectorXd any = Eigen::VectorXd::Random(full->columns());
    const Eigen::VectorXd tractions = T * any;
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double size = 0.0;
    for (std::size_t f = 0; f < 2; ++f)
        for (const std::int32_t triangle : input.faces[f].triangles)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) {
                    const auto& vertices = input.faces[f].vertices;
                    const auto at = [&](int c) { return std::lower_bound(vertices.begin(), vertices.end(), input.mesh->body.triangles(triangle, c)) - vertices.begin(); };
                    const Vec3 part = (a == b ? 2.0 : 1.0) / 24.0 * areaVector(input.mesh->body, triangle).norm() *
                                      tractions.segment<3>(full->firstColumn[f] + 3 * at(b));
                    const Vec3 p = input.mesh->body.vertices.row(input.mesh->body.triangles(triangle, a)).transpose();
                    force += part;
                    moment += p.cross(part);
                    size += part.norm();
                }
    CHECK(force.norm() <= 1e-11 * size);
    CHECK(moment.norm() <= 1e-11 * size);
}

TEST_CASE("full basis: its response is that of the full solution") {
    const ResponseInput input = fullInput(oblique(), BasisKind::Full, 0.45, "refined:300");
    const auto full = buildResponse(input, {});
    REQUIRE(full);
    std::srand(5);
    const Eigen::VectorXd v = 0.1 * Eigen::VectorXd::Random(full->columns());
    std::vector<Points> faces;
    for (std::size_t f = 0; f < input.faces.size(); ++f) {
        Points moved(static_cast<Eigen::Index>(input.faces[f].vertices.size()), 3);
        for (Eigen::Index i = 0; i < moved.rows(); ++i)
            moved.row(i) = (input.faces[f].frame.axes * v.segment<3>(full->firstColumn[f] + 3 * i)).transpose();
        faces.push_back(moved);
    }
    const auto direct = solveFull(input, faces, {});
    REQUIRE(direct);
    const Eigen::VectorXd u = full->response * v;
    for (std::size_t i = 0; i < full->freeVertices.size(); ++i)
        CHECK((direct->row(full->freeVertices[i]).transpose() - u.segment<3>(3 * static_cast<Eigen::Index>(i))).norm() <= 1e-11);
}

TEST_CASE("body loads: a response has them when they are asked for, and is the same otherwise") {
    for (const BasisKind basis : {BasisKind::Paper, BasisKind::Affine, BasisKind::Full}) {
        ResponseInput input = fullInput(oblique(), basis, 0.4, "as-is");
        const auto without = buildResponse(input, {});
        const ContentKey key = responseKey(input);
        input.loads = BodyLoads::Always;
        const auto with = buildResponse(input, {});
        REQUIRE(without);
        REQUIRE(with);
        CHECK(without->loads.size() == 0);
        CHECK(without->loadForces.size() == 0);
        CHECK(responseKey(input) != key);
        CHECK(with->loads.rows() == with->response.rows());
        CHECK(with->loads.cols() == 4);
        CHECK(with->loadForces.rows() == with->columns());
        CHECK((with->response - without->response).norm() <= 1e-12 * with->response.norm());
        CHECK((with->stiffness - without->stiffness).norm() <= 1e-12 * with->stiffness.norm());
        CHECK(with->bytes() > without->bytes());
    }
}

TEST_CASE("body loads: the faces carry exactly the weight and its moment, and the pressure on the open part") {
    auto body = oblique();
    body.ends.pop_back();
    ResponseInput input = fullInput(body, BasisKind::Full);
    input.loads = BodyLoads::Always;
    const auto full = buildResponse(input, {});
    REQUIRE(full);
    const Eigen::MatrixXd carried = rigidMotions(input, *full).transpose() * full->loadForces;  // forces and moments about the origin
    double volume = 0.0;
    Vec3 first = Vec3::Zero(), covered = Vec3::Zero(), coveredMoment = Vec3::Zero();
    const auto& mesh = body.mesh;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        const Vec3 sum = (mesh.vertices.row(mesh.triangles(f, 0)) + mesh.vertices.row(mesh.triangles(f, 1)) + mesh.vertices.row(mesh.triangles(f, 2))).transpose();
        const double cone = areaVector(mesh, f).dot(Vec3(mesh.vertices.row(mesh.triangles(f, 0)).transpose())) / 6.0;
        volume += cone;
        first += cone * sum / 4.0;
    }
    for (const std::int32_t f : input.faces[0].triangles) {
        const Vec3 sum = (mesh.vertices.row(mesh.triangles(f, 0)) + mesh.vertices.row(mesh.triangles(f, 1)) + mesh.vertices.row(mesh.triangles(f, 2))).transpose();
        covered += 0.5 * areaVector(mesh, f);
        coveredMoment += (sum / 3.0).cross(0.5 * areaVector(mesh, f));
    }
    for (int axis = 0; axis < 3; ++axis) {
        CHECK((carried.col(axis).head<3>() + volume * Vec3::Unit(axis)).norm() <= 1e-10 * volume);
        CHECK((carried.col(axis).tail<3>() + first.cross(Vec3::Unit(axis))).norm() <= 1e-10 * volume);
    }
    // A pressure all around has no force and no moment.
    CHECK((carried.col(3).head<3>() - covered).norm() <= 1e-10 * covered.norm());
    CHECK((carried.col(3).tail<3>() - coveredMoment).norm() <= 1e-10 * covered.norm());
}

TEST_CASE("body loads: what the faces carry is what moving them would do against the load") {
    // Reciprocity: forces on the joint parameters are minus the work of the load on the response of each parameter, as far as the
    // discretisation goes: the work is summed here over the body's coarse triangles.
    ResponseInput input = fullInput(oblique(18, 10), BasisKind::Affine);
    input.loads = BodyLoads::Always;
    const auto response = buildResponse(input, {});
    REQUIRE(response);
    Eigen::MatrixXd work = Eigen::MatrixXd::Zero(response->columns(), 4);
    const auto& mesh = input.mesh->body;
    // Pressure only: an integral over the free surface, linear displacement.
    std::vector<Eigen::Index> row(static_cast<std::size_t>(mesh.vertices.rows()), -1);
    for (std::size_t i = 0; i < response->freeVertices.size(); ++i) row[static_cast<std::size_t>(response->freeVertices[i])] = 3 * static_cast<Eigen::Index>(i);
    std::vector<char> covered(static_cast<std::size_t>(mesh.triangles.rows()));
    for (const auto& face : input.faces)
        for (const std::int32_t f : face.triangles) covered[static_cast<std::size_t>(f)] = 1;
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f) {
        if (covered[static_cast<std::size_t>(f)]) continue;
        for (int c = 0; c < 3; ++c) {
            const std::int32_t v = mesh.triangles(f, c);
            const Vec3 share = areaVector(mesh, f) / 6.0;
            if (row[static_cast<std::size_t>(v)] >= 0) {
                work.col(3) += response->response.middleRows(row[static_cast<std::size_t>(v)], 3).transpose() * share;
                continue;
            }
            for (std::size_t k = 0; k < input.faces.size(); ++k) {
                const auto& face = input.faces[k];
                if (!std::binary_search(face.vertices.begin(), face.vertices.end(), v)) continue;
                const Eigen::MatrixXd at = face.frame.axes * response->bases[k].at(face.frame.toLocal(mesh.vertices.row(v).transpose()));
                work.col(3).segment(response->firstColumn[k], at.cols()) += at.transpose() * share;
            }
        }
    }
    MESSAGE("work of the pressure " << work.col(3).norm() << ", missed " << (work.col(3) + response->loadForces.col(3)).norm());
    CHECK((work.col(3) + response->loadForces.col(3)).norm() <= 0.1 * work.col(3).norm());
}

TEST_CASE("full basis: estimates know its columns") {
    const auto full = estimateResponse(fullInput(oblique(), BasisKind::Full)), affine = estimateResponse(fullInput(oblique(), BasisKind::Affine));
    CHECK(full.columns > affine.columns);
    CHECK(full.bytes > affine.bytes);
    CHECK(full.seconds > affine.seconds);
}
