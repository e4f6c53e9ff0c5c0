// SPDX-License-Identifier: GPL-3.0-or-later
// Orders of convergence, printed as tables and asserted at nine tenths of what the method promises.
#include <doctest/doctest.h>
#include <lapacke.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/elasticity/boundary_problem.h"
#include "core/elasticity/kernels.h"
#include "core/mesh/topology.h"
#include "core/meshing/rim_layers.h"
#include "core/reduction/element_response.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

constexpr double kOfThePromise = 0.9;

/// All edges of which no triangle belongs to a face.
std::vector<std::array<std::int32_t, 2>> freeEdges(const SolverMesh& mesh) {
    std::vector<char> held(static_cast<std::size_t>(mesh.mesh.triangles.rows()));
    for (const auto& face : mesh.faces)
        for (const std::int32_t t : face.triangles) held[static_cast<std::size_t>(t)] = 1;
    const EdgeTable edges(mesh.mesh.triangles);
    std::vector<std::array<std::int32_t, 2>> out;
    for (int e = 0; e < edges.size(); ++e) {
        bool free = true;
        for (const EdgeUse& use : edges.uses(e)) free = free && !held[static_cast<std::size_t>(use.triangle)];
        if (free) out.push_back({edges.uses(e)[0].low, edges.uses(e)[0].high});
    }
    return out;
}

SolverMesh solverMeshOf(const shapes::Body& body) {
    SolverMesh mesh;
    mesh.mesh = body.mesh;
    for (const auto& end : body.ends) mesh.faces.push_back({end.vertices, end.triangles});
    return mesh;
}

BoundaryProblem::Input problemOf(const SolverMesh& mesh, double nu) {
    BoundaryProblem::Input input;
    input.mesh = &mesh.mesh;
    for (const auto& face : mesh.faces) input.held.push_back({face.vertices, face.triangles});
    input.bubbles = mesh.bubbles;
    input.nu = nu;
    return input;
}

/// The field at the held vertices, stacked.
template <class Field>
Eigen::MatrixXd heldValues(const SolverMesh& mesh, Field field) {
    std::vector<double> out;
    for (const auto& face : mesh.faces)
        for (const std::int32_t v : face.vertices) {
            const Vec3 u = field(Vec3(mesh.mesh.vertices.row(v).transpose()));
            out.insert(out.end(), u.data(), u.data() + 3);
        }
    return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/// Prints one line; the order against the line before, by cells per side.
struct OrderTable {
    explicit OrderTable(const char* title) { std::printf("%s\n  %8s %8s %12s %8s\n", title, "cells", "nodes", "error", "order"); }
    double add(double cells, int nodes, double error) {
        const double order = error_ > 0.0 ? std::log(error_ / error) / std::log(cells / cells_) : 0.0;
        std::printf("  %8g %8d %12.3e", cells, nodes, error);
        error_ > 0.0 ? std::printf(" %8.2f\n", order) : std::printf("\n");
        cells_ = cells;
        error_ = error;
        return order;
    }

private:
    double cells_ = 0.0, error_ = 0.0;
};

/// Kelvin's field of a force outside of the body, shear modulus 1.
struct PointForce {
    double nu = 0.3;
    Vec3 source = Vec3(1.0, 0.3, 0.6), force = Vec3(1.0, -0.5, 0.7);

    [[nodiscard]] Vec3 displacement(const Vec3& p) const {
        const Vec3 r = p - source;
        const double R = r.norm();
        return ((3.0 - 4.0 * nu) * force + r * r.dot(force) / (R * R)) / (16.0 * std::numbers::pi * (1.0 - nu) * R);
    }
    [[nodiscard]] Eigen::Matrix3d stress(const Vec3& p) const {
        const Vec3 r = p - source;
        const double R = r.norm(), R3 = R * R * R, rf = r.dot(force);
        const Eigen::Matrix3d gradient = ((rf * Eigen::Matrix3d::Identity() + r * force.transpose() - (3.0 - 4.0 * nu) * force * r.transpose()) / R3 -
                                          3.0 * rf * r * r.transpose() / (R3 * R * R)) /
                                         (16.0 * std::numbers::pi * (1.0 - nu));
        const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
        return 2.0 * strain + 2.0 * nu / (1.0 - 2.0 * nu) * strain.trace() * Eigen::Matrix3d::Identity();
    }
};

/// Relative error (2-norm over the nodes) of the displacement of a cube under the tractions of a point force beside it: H u = G t with all of t
/// known, u up to a rigid motion, which is taken from the exact field.
double pointForceError(int cells, bool quadratic, int& nodes) {
    const PointForce exact;
    shapes::Body cube = shapes::bar(cells, 1.0);
    cube.ends.clear();
    SolverMesh mesh = solverMeshOf(cube);
    if (quadratic) mesh.bubbles = freeEdges(mesh);
    const BoundaryEquation equation(mesh.mesh, EdgeTable(mesh.mesh.triangles), {}, mesh.bubbles, exact.nu);
    nodes = equation.nodes();
    const double size = (cube.mesh.vertices.colwise().maxCoeff() - cube.mesh.vertices.colwise().minCoeff()).norm();
    const Vec3 middle = 0.5 * (cube.mesh.vertices.colwise().maxCoeff() + cube.mesh.vertices.colwise().minCoeff()).transpose();

    // G t by linear tractions on triangles cut in 4 and in 16, extrapolated, so that what remains falls sooner than what is measured.
    struct Part {
        std::array<Vec3, 3> p, t;
    };
    std::vector<Part> parts;
    for (const int cuts : {2, 4})
        for (std::int32_t f = 0; f < cube.mesh.triangles.rows(); ++f) {
            const Vec3 normal = areaVector(cube.mesh, f).normalized() * (cuts == 2 ? -1.0 / 3.0 : 4.0 / 3.0);
            const auto corner = [&](int c) -> Vec3 { return cube.mesh.vertices.row(cube.mesh.triangles(f, c)).transpose(); };
            const auto at = [&](int i, int j) -> Vec3 { return corner(0) + (corner(1) - corner(0)) * i / cuts + (corner(2) - corner(0)) * j / cuts; };
            const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
                parts.push_back({{a, b, c}, {Vec3(exact.stress(a) * normal), Vec3(exact.stress(b) * normal), Vec3(exact.stress(c) * normal)}});
            };
            for (int i = 0; i < cuts; ++i)
                for (int j = 0; i + j < cuts; ++j) {
                    add(at(i, j), at(i + 1, j), at(i, j + 1));
                    if (i + j + 2 <= cuts) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                }
        }
    const int n = 3 * nodes, bordered = n + 6, vertices = 3 * equation.freeCount();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(bordered, bordered);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(bordered), u = Eigen::VectorXd::Zero(n);
    std::vector<double> h(9 * (static_cast<std::size_t>(nodes) + 1));
    const auto place = [&](std::int32_t node) -> Vec3 { return middle + size * equation.position(node); };
    for (std::int32_t i = 0; i < nodes; ++i) {
        equation.row(i, h.data(), nullptr);
        for (int j = 0; j < nodes; ++j)
            A.block<3, 3>(3 * i, 3 * j) = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data() + 9 * static_cast<std::size_t>(j));
        const Vec3 x = place(i);
        for (const Part& part : parts) {
            const PairBlocks blocks = pairBlocks(x, part.p, exact.nu);
            for (std::size_t c = 0; c < 3; ++c) b.segment<3>(3 * i) += blocks.g[c] * part.t[c];
        }
        u.segment<3>(3 * i) = exact.displacement(x);
        Eigen::Matrix<double, 3, 6> rigid;
        for (int axis = 0; axis < 3; ++axis) {
            rigid.col(axis) = Vec3::Unit(axis);
            rigid.col(3 + axis) = Vec3::Unit(axis).cross(equation.position(i));
        }
        A.block<3, 6>(3 * i, n) = rigid;
        if (3 * i < vertices) A.block<6, 3>(n, 3 * i) = rigid.transpose();
    }
    b.tail<6>() = A.bottomLeftCorner(6, vertices) * u.head(vertices);
    std::vector<int> pivots(static_cast<std::size_t>(bordered));
    REQUIRE(LAPACKE_dgesv(LAPACK_COL_MAJOR, bordered, 1, A.data(), bordered, pivots.data(), b.data(), bordered) == 0);
    return (b.head(vertices) - u.head(vertices)).norm() / u.head(vertices).norm();
}

}  // namespace

TEST_CASE("convergence: a cube under the tractions of a point force, of order 2 with linear and 3 with quadratic displacement") {
    // Interpolation leaves h^2 of a smooth field with linear functions and h^3 with quadratic ones, and collocation at their nodes keeps that (Atkinson 1997,
    // chapter 9: second-kind equations on polyhedra).
    for (const bool quadratic : {false, true}) {
        OrderTable table(quadratic ? "point force beside a cube, quadratic displacement" : "point force beside a cube, linear displacement");
        double order = 0.0;
        for (const int cells : quadratic ? std::vector<int>{2, 4, 6} : std::vector<int>{4, 6}) {
            int nodes = 0;
            const double error = pointForceError(cells, quadratic, nodes);
            order = table.add(cells, nodes, error);
        }
        CHECK(order >= kOfThePromise * (quadratic ? 3.0 : 2.0));
    }
}

TEST_CASE("convergence: the torque of a twisted square bar goes to Saint-Venant's with order 2, quadratic displacement sooner") {
    // Warping is held at the ends, so the torque is taken from two bars of different length: the difference of their compliances is that of the
    // middle alone. J = 0.140577 a^4.
    const double nu = 0.3;
    for (const bool quadratic : {false, true}) {
        const auto compliance = [&](int cells, double length, int& nodes) {
            const shapes::Body body = shapes::box(Vec3(-0.5, -0.5, 0), Vec3(0.5, 0.5, length), cells, cells, static_cast<int>(cells * length));
            SolverMesh mesh = solverMeshOf({body.mesh, {shapes::patchWhere(body.mesh, [](const Vec3& p) { return p.z() == 0.0; }),
                                                        shapes::patchWhere(body.mesh, [&](const Vec3& p) { return p.z() == length; })}});
            if (quadratic) mesh.bubbles = freeEdges(mesh);
            auto problem = BoundaryProblem::build(problemOf(mesh, nu), {});
            REQUIRE(problem);
            const auto solution = problem->solve(heldValues(mesh, [&](const Vec3& p) { return Vec3(p.z() > 0.0 ? Vec3(-p.y(), p.x(), 0.0) : Vec3::Zero()); }), {});
            REQUIRE(solution);
            nodes = static_cast<int>(mesh.mesh.vertices.rows() + static_cast<Eigen::Index>(mesh.bubbles.size()));
            std::vector<Eigen::Index> row(static_cast<std::size_t>(mesh.mesh.vertices.rows()));
            Eigen::Index next = 0;
            for (const auto& face : mesh.faces)
                for (const std::int32_t v : face.vertices) row[static_cast<std::size_t>(v)] = 3 * next++;
            double torque = 0.0;
            for (const std::int32_t f : mesh.faces[1].triangles)
                for (int a = 0; a < 3; ++a)
                    for (int b = 0; b < 3; ++b) {
                        const Vec3 p = mesh.mesh.vertices.row(mesh.mesh.triangles(f, a)).transpose();
                        const Vec3 t = solution->traction.block<3, 1>(row[static_cast<std::size_t>(mesh.mesh.triangles(f, b))], 0);
                        torque += (a == b ? 2.0 : 1.0) * 0.5 * areaVector(mesh.mesh, f).norm() / 12.0 * (p.x() * t.y() - p.y() * t.x());
                    }
            return 1.0 / torque;
        };
        OrderTable table(quadratic ? "torsion of a square bar, quadratic displacement" : "torsion of a square bar, linear displacement");
        double order = 0.0, error = 0.0;
        for (const int cells : quadratic ? std::vector<int>{1, 2, 3} : std::vector<int>{2, 4, 6}) {
            int nodes = 0, unused = 0;
            const double J = 1.0 / (compliance(cells, 3.0, nodes) - compliance(cells, 2.0, unused));
            error = std::abs(J / 0.140577 - 1.0);
            order = table.add(cells, nodes, error);
        }
        if (!quadratic) CHECK(order >= kOfThePromise * 2.0);
        CHECK(error <= (quadratic ? 0.005 : 0.03));
    }
}

TEST_CASE("convergence: more strips at the rims leave less, at 90 degrees and where a barrel leaves its joint plane") {
    shapes::Body barrel = shapes::cylinder(0.5, 1.5, 10, 6);
    for (Eigen::Index v = 0; v < barrel.mesh.vertices.rows(); ++v) {
        const double z = barrel.mesh.vertices(v, 2) / 1.5, bulge = 1.0 + 1.2 * 4.0 * z * (1.0 - z);
        barrel.mesh.vertices(v, 0) *= bulge;
        barrel.mesh.vertices(v, 1) *= bulge;
    }
    const std::pair<const char*, shapes::Body> bodies[] = {{"strips at the rims of a square bar", shapes::bar(2, 2.0)}, {"strips at the rims of a barrel", barrel}};
    for (const auto& [title, body] : bodies) {
        const auto motion = [&](int layers, int& nodes) {
            SolverMesh mesh = withLayers(solverMeshOf(body), layers);
            mesh.bubbles = freeEdges(mesh);
            nodes = static_cast<int>(mesh.mesh.vertices.rows() + static_cast<Eigen::Index>(mesh.bubbles.size()));
            auto problem = BoundaryProblem::build(problemOf(mesh, 0.3), {});
            REQUIRE(problem);
            // Shear, bending, stretch and twist at once; the other end is held.
            const auto solution = problem->solve(
                heldValues(mesh, [](const Vec3& p) { return p.z() > 0.5 ? Vec3(0.2 - 0.3 * p.y(), 0.3 * p.x(), 0.2 - 0.4 * p.x()) : Vec3(0, 0, 0); }), {});
            REQUIRE(solution);
            Eigen::Index own = 0;
            while (own < static_cast<Eigen::Index>(problem->freeVertices().size()) && problem->freeVertices()[static_cast<std::size_t>(own)] < body.mesh.vertices.rows()) ++own;
            return Eigen::MatrixXd(solution->displacement.topRows(3 * own));
        };
        int nodes = 0;
        const Eigen::MatrixXd reference = motion(6, nodes);
        OrderTable table(title);
        std::vector<double> error;
        for (const int layers : {1, 2, 3, 4}) {
            error.push_back((motion(layers, nodes) - reference).norm() / reference.norm());
            table.add(layers, nodes, error.back());
        }
        // The width of the first strip falls as layers^-3 and the solution varies like r^0.6 or so at it: order 1.8, until what lies between the strips decides.
        CHECK(error[1] < error[0]);
        CHECK(error[2] < error[1]);
        CHECK(error[2] <= 0.3 * error[0]);
        CHECK(error[2] <= 0.01);
    }
}

namespace {

ResponseInput inputOf(const shapes::Body& body, const char* solverMesh) {
    auto mesh = std::make_shared<ElementMesh>();
    mesh->body = body.mesh;
    ResponseInput input;
    input.mesh = mesh;
    for (const auto& end : body.ends) input.faces.push_back(jointFaceByVertices(body.mesh, end.vertices).value());
    input.nu = 0.3;
    input.solverMesh = parseSolverMesh(solverMesh).value();
    return input;
}

}  // namespace

TEST_CASE("convergence: the joint stiffness goes to a limit and its raw form to a symmetric one, the default being there already") {
    const shapes::Body body = shapes::bar(2);
    const auto solved = [&](const char* solverMesh) {
        auto response = buildResponse(inputOf(body, solverMesh), {});
        REQUIRE(response);
        return std::move(*response);
    };
    const ElementResponse reference = solved("default");
    // In parameters of unit stiffness, so that metres and radians weigh the same.
    const Eigen::VectorXd unit = reference.stiffness.diagonal().cwiseSqrt().cwiseInverse();
    const auto difference = [&](const ElementResponse& r) {
        const Eigen::MatrixXd a = unit.asDiagonal() * r.stiffness * unit.asDiagonal(), b = unit.asDiagonal() * reference.stiffness * unit.asDiagonal();
        return (a - b).norm() / b.norm();
    };
    std::printf("joint stiffness of a square bar\n  %-12s %8s %12s %12s\n", "mesh", "nodes", "from default", "asymmetry");
    double before = 1.0, asymmetry = 1.0;
    for (const char* solverMesh : {"as-is", "refined:112", "refined:224", "refined:448"}) {
        const ElementResponse r = solved(solverMesh);
        std::printf("  %-12s %8d %12.3e %12.3e\n", solverMesh, r.quality.solverNodes, difference(r), r.quality.asymmetry);
        CHECK(difference(r) < before);
        CHECK(r.quality.asymmetry < asymmetry);
        before = difference(r);
        asymmetry = r.quality.asymmetry;
    }
    std::printf("  %-12s %8d %12s %12.3e\n", "default", reference.quality.solverNodes, "", reference.quality.asymmetry);
    CHECK(reference.quality.asymmetry < 0.5 * asymmetry);
}
