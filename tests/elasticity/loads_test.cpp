// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/elasticity/boundary_problem.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

using Bubbles = std::vector<std::array<std::int32_t, 2>>;

/// Every edge of which no triangle is held.
Bubbles bubblesEverywhere(const TriangleMesh& mesh, const std::vector<shapes::Patch>& held) {
    std::vector<char> inPatch(static_cast<std::size_t>(mesh.triangles.rows()));
    for (const auto& patch : held)
        for (const std::int32_t f : patch.triangles) inPatch[static_cast<std::size_t>(f)] = 1;
    const EdgeTable edges(mesh.triangles);
    Bubbles out;
    for (int e = 0; e < edges.size(); ++e) {
        bool free = true;
        for (const auto& use : edges.uses(e)) free = free && !inPatch[static_cast<std::size_t>(use.triangle)];
        if (free) out.push_back({edges.uses(e)[0].low, edges.uses(e)[0].high});
    }
    return out;
}

struct Loaded {
    BoundaryProblem::Solution solution;
    std::vector<std::int32_t> freeVertices, heldVertices;
    Eigen::MatrixXd heldForces;  ///< 3 #held x k: of the tractions, by vertex
};

/// The body held at `patches`, which are displaced by `held` (3 #held x k) in the first k columns; the loads follow.
Loaded load(const TriangleMesh& mesh, const std::vector<shapes::Patch>& patches, double nu, const Bubbles& bubbles, int threads = 1,
            const std::function<Vec3(const Vec3&)>& displacement = {}) {
    BoundaryProblem::Input input;
    input.mesh = &mesh;
    Loaded out;
    for (const auto& patch : patches) {
        input.held.push_back({patch.vertices, patch.triangles});
        out.heldVertices.insert(out.heldVertices.end(), patch.vertices.begin(), patch.vertices.end());
    }
    input.bubbles = bubbles;
    input.nu = nu;
    input.threads = threads;
    auto problem = BoundaryProblem::build(input, {});
    REQUIRE(problem);
    Eigen::MatrixXd held = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(out.heldVertices.size()), 1);
    if (displacement)
        for (std::size_t i = 0; i < out.heldVertices.size(); ++i)
            held.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0) = displacement(mesh.vertices.row(out.heldVertices[i]).transpose());
    auto solution = problem->solve(held, BoundaryProblem::Loads{true, nullptr}, {});
    REQUIRE(solution);
    out.solution = std::move(*solution);
    out.freeVertices = problem->freeVertices();
    out.heldForces = Eigen::MatrixXd::Zero(held.rows(), out.solution.traction.cols());
    std::vector<Eigen::Index> row(static_cast<std::size_t>(mesh.vertices.rows()));
    for (std::size_t i = 0; i < out.heldVertices.size(); ++i) row[static_cast<std::size_t>(out.heldVertices[i])] = 3 * static_cast<Eigen::Index>(i);
    for (const auto& patch : patches)
        for (const std::int32_t f : patch.triangles)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b)
                    out.heldForces.middleRows(row[static_cast<std::size_t>(mesh.triangles(f, a))], 3) +=
                        (a == b ? 2.0 : 1.0) / 24.0 * areaVector(mesh, f).norm() *
                        out.solution.traction.middleRows(row[static_cast<std::size_t>(mesh.triangles(f, b))], 3);
    return out;
}

/// Sum of nodal forces, and their moment about the origin.
Eigen::Matrix<double, 6, 1> resultant(const TriangleMesh& mesh, const Loaded& loaded, Eigen::Index column) {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < loaded.heldVertices.size(); ++i) {
        const Vec3 force = loaded.heldForces.block<3, 1>(3 * static_cast<Eigen::Index>(i), column);
        sum.head<3>() += force;
        sum.tail<3>() += Vec3(mesh.vertices.row(loaded.heldVertices[i]).transpose()).cross(force);
    }
    return sum;
}

/// Largest distance from `exact` over the free vertices, relative to its largest value.
double missed(const TriangleMesh& mesh, const Loaded& loaded, const Eigen::VectorXd& u, const std::function<Vec3(const Vec3&)>& exact) {
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < loaded.freeVertices.size(); ++i) {
        const Vec3 wanted = exact(mesh.vertices.row(loaded.freeVertices[i]).transpose());
        worst = std::max(worst, (u.segment<3>(3 * static_cast<Eigen::Index>(i)) - wanted).norm());
        largest = std::max(largest, wanted.norm());
    }
    return largest > 0.0 ? worst / largest : worst;
}

}  // namespace

TEST_CASE("loads: over a closed surface, the force block is the volume integral of Kelvin's solution") {
    const auto body = shapes::box(Vec3(-0.3, -0.2, 0.1), Vec3(0.4, 0.5, 0.6), 1, 1, 1);
    // Gauss-Legendre, eight points per axis: exact to 1e-10 at this distance.
    constexpr std::array<double, 4> at{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    constexpr std::array<double, 4> weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    const auto gauss = [&](int i, double low, double high, double& w) {
        const auto k = static_cast<std::size_t>(i < 4 ? i : i - 4);
        w *= 0.5 * (high - low) * weight[k];
        return 0.5 * (low + high) + 0.5 * (high - low) * (i < 4 ? at[k] : -at[k]);
    };
    for (const double nu : {0.0, 0.3, 0.5})
        for (const Vec3& x : {Vec3(1.2, 0.3, 0.2), Vec3(-0.9, 1.4, -0.7)}) {
            Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
            for (int i = 0; i < 512; ++i) {
                double w = 1.0;
                Vec3 y;
                y.x() = gauss(i / 64, -0.3, 0.4, w);
                y.y() = gauss(i / 8 % 8, -0.2, 0.5, w);
                y.z() = gauss(i % 8, 0.1, 0.6, w);
                const Vec3 r = y - x;
                expected += w / (16.0 * std::numbers::pi * (1.0 - nu) * r.norm()) *
                            ((3.0 - 4.0 * nu) * Eigen::Matrix3d::Identity() + r * r.transpose() / r.squaredNorm());
            }
            Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
            for (Eigen::Index f = 0; f < body.mesh.triangles.rows(); ++f) {
                std::array<Vec3, 3> corners;
                for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = body.mesh.vertices.row(body.mesh.triangles(f, c)).transpose();
                sum += loadBlocks(x, corners, nu).force;
            }
            CHECK((sum - expected).norm() <= 1e-9 * expected.norm());
        }
}

TEST_CASE("loads: vectors of triangles give the sum of single ones, seen from corners, edges, near and far") {
    const auto body = shapes::cylinder(0.4, 0.8, 11, 4);
    std::vector<std::int32_t> every, corner(static_cast<std::size_t>(body.mesh.vertices.rows()));
    for (std::int32_t f = 0; f < body.mesh.triangles.rows() - 3; ++f) every.push_back(f);  // no whole vectors
    const TriangleBatch batch(body.mesh, every, corner);
    std::vector<Vec3> points{Vec3(3, 2, 1), Vec3(0.1, 0.05, 0.3), Vec3(0.1, 0.05, 1e-9)};
    for (Eigen::Index v = 0; v < body.mesh.vertices.rows(); v += 7) points.emplace_back(body.mesh.vertices.row(v).transpose());
    for (Eigen::Index f = 0; f < body.mesh.triangles.rows(); f += 11)
        points.emplace_back(0.5 * (body.mesh.vertices.row(body.mesh.triangles(f, 0)) + body.mesh.vertices.row(body.mesh.triangles(f, 1))).transpose());
    for (const double nu : {0.0, 0.45, 0.5})
        for (const Vec3& x : points) {
            LoadBlocks sum;
            for (const std::int32_t f : every) {
                std::array<Vec3, 3> corners;
                for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = body.mesh.vertices.row(body.mesh.triangles(f, c)).transpose();
                const LoadBlocks one = loadBlocks(x, corners, nu);
                sum.force += one.force;
                sum.pressure += one.pressure;
            }
            const LoadBlocks all = sumLoads(batch, x, nu);
            CHECK((all.force - sum.force).norm() <= 1e-13);
            CHECK((all.pressure - sum.pressure).norm() <= 1e-13);
        }
}

TEST_CASE("loads: a bar that hangs from its top stretches as the square of the height") {
    // nu = 0: one-dimensional, E = 2. u = (L^2 - z^2) / (2 E) for a unit force per volume upwards, and quadratic displacement holds that exactly.
    for (const int n : {1, 2}) {
        auto body = shapes::bar(n);
        body.ends.erase(body.ends.begin());
        const Loaded loaded = load(body.mesh, body.ends, 0.0, bubblesEverywhere(body.mesh, body.ends));
        const auto exact = [](const Vec3& p) { return Vec3(0, 0, (9.0 - p.z() * p.z()) / 4.0); };
        CHECK(missed(body.mesh, loaded, loaded.solution.displacement.col(3), exact) <= 1e-11);
        // The traction at the top carries the weight.
        for (Eigen::Index i = 0; i < loaded.solution.traction.rows(); i += 3)
            CHECK((loaded.solution.traction.block<3, 1>(i, 3) - Vec3(0, 0, -3)).norm() <= 1e-9);
    }
}

TEST_CASE("loads: a bar that hangs from a face of the right shape gets thinner towards it, and linear displacement converges") {
    // The state of uniaxial tension sigma_zz = z of a bar that hangs at z = L (Timoshenko and Goodier, section 86).
    for (const double nu : {0.3, 0.5}) {
        const double E = 2.0 * (1.0 + nu);
        const auto exact = [&](const Vec3& p) {
            return Vec3(Vec3(-nu * p.x() * p.z(), -nu * p.y() * p.z(), 0.5 * (p.z() * p.z() + nu * (p.x() * p.x() + p.y() * p.y()))) / E);
        };
        std::vector<double> error, reaction;
        for (const int n : {2, 4, 8}) {
            auto body = shapes::bar(n, 2.0);
            body.ends.erase(body.ends.begin());
            const Loaded loaded = load(body.mesh, body.ends, nu, {}, 1, exact);
            const Eigen::VectorXd u = loaded.solution.displacement.col(0) - loaded.solution.displacement.col(3);  // a force downwards
            error.push_back(missed(body.mesh, loaded, u, exact));
            const Vec3 force = resultant(body.mesh, loaded, 0).head<3>() - resultant(body.mesh, loaded, 3).head<3>();
            reaction.push_back((force - Vec3(0, 0, 2)).norm() / 2.0);
        }
        MESSAGE("nu " << nu << ", 2 4 8 cells: displacement " << error[0] << " " << error[1] << " " << error[2] << ", reaction " << reaction[0] << " "
                      << reaction[1] << " " << reaction[2]);
        CHECK(error[2] <= 0.01);
        CHECK(std::log2(error[1] / error[2]) >= 0.9 * 1.5);
        CHECK(reaction[2] <= 0.02);
    }
}

TEST_CASE("loads: the faces carry the weight, and the pressure on what is not covered") {
    for (const double nu : {0.0, 0.3, 0.45, 0.5}) {
        const auto body = shapes::cylinder(0.5, 1.5, 18, 10);
        const Loaded loaded = load(body.mesh, {body.ends[0]}, nu, bubblesEverywhere(body.mesh, {body.ends[0]}));
        const double weight = enclosedVolume(body.mesh.vertices, body.mesh.triangles);
        // Collocation balances forces no better than it solves: 1 % here, a small part of what a wrong factor would make of it.
        for (int axis = 0; axis < 3; ++axis) CHECK((resultant(body.mesh, loaded, 1 + axis).head<3>() + weight * Vec3::Unit(axis)).norm() <= 0.02 * weight);
        Vec3 covered = Vec3::Zero();
        for (const std::int32_t f : body.ends[0].triangles) covered += 0.5 * areaVector(body.mesh, f);
        CHECK((resultant(body.mesh, loaded, 4).head<3>() - covered).norm() <= 0.02 * covered.norm());
    }
}

TEST_CASE("loads: pressure all around a body is a uniform tension of it, whatever its shape and Poisson ratio") {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    // Flat faces: there the traction is one vector per face.
    for (const auto& body : {shapes::moved(shapes::bar(2), turn, Vec3(3, -1, 2)), shapes::cylinder(0.5, 1.0, 11, 4)})
        for (const double nu : {0.0, 0.3, 0.4999, 0.5}) {
            const double c = (1.0 - 2.0 * nu) / (2.0 * (1.0 + nu));  // p / (3 K), shear modulus 1
            const auto exact = [&](const Vec3& p) { return Vec3(c * p); };
            const Loaded loaded = load(body.mesh, body.ends, nu, {}, 1, exact);
            const Eigen::VectorXd u = loaded.solution.displacement.col(0) + loaded.solution.displacement.col(4);
            const double size = body.mesh.vertices.rowwise().norm().maxCoeff();
            CHECK(missed(body.mesh, loaded, u, exact) * (c > 0.0 ? c : 1.0) <= 1e-12 * size);
        }
}

TEST_CASE("loads: they turn, move and grow with the body") {
    const auto body = shapes::bar(2);
    const Loaded still = load(body.mesh, body.ends, 0.4, bubblesEverywhere(body.mesh, body.ends));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(-1, 2, 0.5).normalized()).toRotationMatrix();
    for (const double size : {1e-3, 1.0, 1e3}) {
        const auto other = shapes::moved(body, size * turn, size * Vec3(2, -3, 1));
        const Loaded moved = load(other.mesh, body.ends, 0.4, bubblesEverywhere(body.mesh, body.ends));
        const Eigen::MatrixXd &X = still.solution.displacement, &Y = moved.solution.displacement;
        for (Eigen::Index i = 0; i < X.rows(); i += 3) {
            const Eigen::Matrix3d force = size * size * turn * X.block<3, 3>(i, 1) * turn.transpose();
            CHECK((Y.block<3, 3>(i, 1) - force).norm() <= 1e-10 * size * size);
            CHECK((Y.block<3, 1>(i, 4) - size * turn * X.block<3, 1>(i, 4)).norm() <= 1e-10 * size);
        }
    }
}

TEST_CASE("loads: the same bytes for any number of threads, and nothing of what is prescribed changes") {
    const auto body = shapes::cylinder(0.5, 1.5, 12, 6);
    const auto bubbles = bubblesEverywhere(body.mesh, body.ends);
    const auto shift = [](const Vec3& p) { return Vec3(p.y(), 0.3, p.z()); };
    const Loaded one = load(body.mesh, body.ends, 0.4, bubbles, 1, shift), two = load(body.mesh, body.ends, 0.4, bubbles, 2, shift);
    CHECK(one.solution.displacement == two.solution.displacement);
    CHECK(one.solution.traction == two.solution.traction);
    CHECK(one.solution.displacement.cols() == 1 + BoundaryEquation::kLoads);
}
