// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/volume_problem.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "core/worker/worker.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// A body whose ends are held, filled.
struct Filled {
    shapes::Body body;
    TetrahedralMesh tetrahedra;
    VolumeProblem::Input input;

    Filled(shapes::Body made, double size, double nu, int threads = 2) : body(std::move(made)) {
        TetrahedronSizes sizes;
        sizes.most = size;
        auto filled = fillWithTetrahedra(body.mesh, sizes, {});
        REQUIRE_MESSAGE(filled, filled.error().message);
        tetrahedra = std::move(*filled);
        input.surface = &body.mesh;
        input.tetrahedra = &tetrahedra;
        for (const shapes::Patch& end : body.ends) input.held.push_back({end.vertices, end.triangles});
        input.nu = nu;
        input.threads = threads;
    }
    [[nodiscard]] Eigen::MatrixXd held(const std::function<Vec3(const Vec3&)>& motion) const {
        std::vector<double> values;
        for (const shapes::Patch& end : body.ends)
            for (const std::int32_t v : end.vertices) {
                const Vec3 u = motion(body.mesh.vertices.row(v).transpose());
                values.insert(values.end(), u.data(), u.data() + 3);
            }
        return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    }
    /// Largest difference from `exact` at the free vertices.
    [[nodiscard]] double worst(const VolumeProblem& problem, const Eigen::MatrixXd& displacement, Eigen::Index column, const std::function<Vec3(const Vec3&)>& exact) const {
        double out = 0.0;
        const auto& vertices = problem.freeVertices();
        for (std::size_t i = 0; i < vertices.size(); ++i)
            out = std::max(out, (displacement.col(column).segment<3>(3 * static_cast<Eigen::Index>(i)) - exact(body.mesh.vertices.row(vertices[i]).transpose())).norm());
        return out;
    }
};

double volumeOf(const TetrahedralMesh& mesh) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < mesh.tetrahedra.rows(); ++t) {
        const auto corner = [&](int c) -> Vec3 { return mesh.vertices.row(mesh.tetrahedra(t, c)).transpose(); };
        const double six = (corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(corner(3) - corner(0));
        CHECK(six > 0.0);
        sum += six / 6.0;
    }
    return sum;
}

/// Rounding times a condition number that is below 1e5 for meshes as small as these.
constexpr double kExactly = 1e-9;

}  // namespace

TEST_CASE("tetrahedra: fill exactly the body, its cavity stays empty, the same bytes each time") {
    shapes::Body block = shapes::box(Vec3(0, 0, 0), Vec3(3, 3, 3), 3, 3, 3);
    shapes::Body hole = shapes::inverted(shapes::box(Vec3(1, 1, 1), Vec3(2, 2, 2), 1, 1, 1));
    TriangleMesh both;
    both.vertices.resize(block.mesh.vertices.rows() + hole.mesh.vertices.rows(), 3);
    both.vertices << block.mesh.vertices, hole.mesh.vertices;
    both.triangles.resize(block.mesh.triangles.rows() + hole.mesh.triangles.rows(), 3);
    both.triangles << block.mesh.triangles, hole.mesh.triangles.array() + static_cast<std::int32_t>(block.mesh.vertices.rows());
    TetrahedronSizes sizes;
    sizes.most = 0.5;
    const auto filled = fillWithTetrahedra(both, sizes, {}), again = fillWithTetrahedra(both, sizes, {});
    REQUIRE_MESSAGE(filled, filled.error().message);
    REQUIRE(again);
    CHECK(volumeOf(*filled) == doctest::Approx(26.0).epsilon(1e-12));
    CHECK(filled->vertices.topRows(both.vertices.rows()) == both.vertices);
    CHECK(filled->vertices == again->vertices);
    CHECK(filled->tetrahedra == again->tetrahedra);
}

TEST_CASE("tetrahedra: the smaller they are wanted, the more there are inside, graded around points") {
    const shapes::Body block = shapes::box(Vec3(0, 0, 0), Vec3(4, 4, 4), 4, 4, 4);
    TetrahedronSizes sizes;
    sizes.most = 4.0;
    const auto coarse = fillWithTetrahedra(block.mesh, sizes, {});
    sizes.points = {{Vec3(2, 2, 2), 0.3}};
    const auto graded = fillWithTetrahedra(block.mesh, sizes, {});
    REQUIRE(coarse);
    REQUIRE(graded);
    CHECK(graded->tetrahedra.rows() > 2 * coarse->tetrahedra.rows());
    CHECK(volumeOf(*graded) == doctest::Approx(64.0).epsilon(1e-12));
    CHECK(sizes.at(Vec3(2, 2, 3)) == doctest::Approx(0.8));
}

TEST_CASE("tetrahedra: a surface that meets itself is refused with the reason, and a cancelled filling says so") {
    shapes::Body one = shapes::box(Vec3(0, 0, 0), Vec3(2, 2, 2), 2, 2, 2), other = shapes::box(Vec3(1.1, 0.9, 0.7), Vec3(3.1, 2.9, 2.7), 2, 2, 2);
    TriangleMesh both;
    both.vertices.resize(2 * one.mesh.vertices.rows(), 3);
    both.vertices << one.mesh.vertices, other.mesh.vertices;
    both.triangles.resize(2 * one.mesh.triangles.rows(), 3);
    both.triangles << one.mesh.triangles, other.mesh.triangles.array() + static_cast<std::int32_t>(one.mesh.vertices.rows());
    TetrahedronSizes sizes;
    sizes.most = 1.0;
    const auto refused = fillWithTetrahedra(both, sizes, {});
    REQUIRE(!refused);
    CHECK(refused.error().code == "no-filling");
    std::stop_source stop;
    stop.request_stop();
    const auto cancelled = fillWithTetrahedra(one.mesh, sizes, Progress({}, stop.get_token()));
    REQUIRE(!cancelled);
    CHECK(cancelled.error().code == kCancelled);
}

TEST_CASE("tetrahedra: the same, byte for byte, made here and by a worker") {
    const shapes::Body body = shapes::sphere(1.0, 3);
    TetrahedronSizes sizes;
    sizes.most = 0.2;
    sizes.points.push_back({Vec3(0.0, 0.0, 1.0), 0.05});
    setWorkerProgram({});
    const auto here = fillWithTetrahedra(body.mesh, sizes, {});
    setWorkerProgram("/proc/self/exe");
    const auto there = fillWithTetrahedra(body.mesh, sizes, {});
    const auto again = fillWithTetrahedra(body.mesh, sizes, {});
    REQUIRE(here);
    REQUIRE(there);
    REQUIRE(again);
    CHECK(there->vertices == here->vertices);
    CHECK(there->tetrahedra == here->tetrahedra);
    CHECK(again->tetrahedra == here->tetrahedra);
}

TEST_CASE("volume problem: drawn out evenly and moved rigidly a bar is exact at any Poisson ratio, and rigid motions take no force") {
    for (const double nu : {0.0, 0.3, 0.45, 0.49}) {
        const Filled bar(shapes::box(Vec3(0, 0, 0), Vec3(1, 1.2, 2), 2, 2, 4), 0.5, nu);
        auto problem = VolumeProblem::build(bar.input, {});
        REQUIRE_MESSAGE(problem, problem.error().message);
        const auto drawn = [&](const Vec3& p) -> Vec3 { return Vec3(-nu * p.x(), -nu * p.y(), p.z()); };
        const auto rigid = [](const Vec3& p) -> Vec3 { return Vec3(1, -2, 0.5) + Vec3(0.3, 0.1, -0.7).cross(p); };
        Eigen::MatrixXd held(bar.held(drawn).rows(), 2);
        held << bar.held(drawn), bar.held(rigid);
        const auto solution = problem->solve(held, {}, {});
        REQUIRE(solution);
        CHECK(bar.worst(*problem, solution->displacement, 0, drawn) < kExactly);
        CHECK(bar.worst(*problem, solution->displacement, 1, rigid) < kExactly);
        // Young's modulus 2 (1 + nu) over the cross-section 1.2, strain 1 over a volume of 2.4.
        CHECK(held.col(0).dot(solution->forces.col(0)) == doctest::Approx(2.0 * (1.0 + nu) * 2.4).epsilon(kExactly));
        CHECK(solution->forces.col(1).norm() < kExactly);
        CHECK(problem->quality().residual < 1e-12);
    }
}

TEST_CASE("volume problem: a bar that hangs by its weight is exact, and the force that holds it is its weight") {
    shapes::Body hung = shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 2), 2, 2, 3);
    hung.ends.erase(hung.ends.begin());  // held at z = 2
    const Filled bar(std::move(hung), 0.7, 0.0);
    auto problem = VolumeProblem::build(bar.input, {});
    REQUIRE(problem);
    const Eigen::MatrixXd none(3 * static_cast<Eigen::Index>(bar.body.ends[0].vertices.size()), 0);
    const Eigen::MatrixXd pull = Eigen::MatrixXd::Ones(bar.body.mesh.vertices.rows(), 1);
    const auto solution = problem->solve(none, {true, &pull}, {});
    REQUIRE(solution);
    REQUIRE(solution->displacement.cols() == 7);
    // Force 1 per volume, Young's modulus 2, no lateral contraction: u_z = (4 - z^2) / 4.
    CHECK(bar.worst(*problem, solution->displacement, 2, [](const Vec3& p) -> Vec3 { return Vec3(0, 0, (4.0 - p.z() * p.z()) / 4.0); }) < kExactly);
    double weight = 0.0, pressed = 0.0, pulled = 0.0;
    for (Eigen::Index row = 2; row < solution->forces.rows(); row += 3) {
        weight += solution->forces(row, 2);
        pressed += solution->forces(row, 3);
        pulled += solution->forces(row, 4 + 2);
    }
    CHECK(weight == doctest::Approx(-2.0).epsilon(kExactly));
    CHECK(pressed == doctest::Approx(1.0).epsilon(kExactly));   // the pressure on the lower end alone pulls down
    CHECK(pulled == doctest::Approx(-9.0).epsilon(kExactly));  // four sides of 2 and the lower end
    CHECK((solution->compliance - solution->compliance.transpose()).norm() < kExactly);
    CHECK(solution->compliance(0, 0) > 0.0);
}

TEST_CASE("volume problem: a bent bar converges with the square of the size, in energy and displacement") {
    // u is quadratic, and so exact inside; what is held is linear on triangles, whose error falls with the square of their size.
    constexpr double kNu = 0.3;
    const auto bent = [](const Vec3& q) -> Vec3 {
        const double x = q.x() - 0.5, y = q.y() - 0.5, z = q.z();
        return {-0.5 * (z * z + kNu * (x * x - y * y)), -kNu * x * y, x * z};
    };
    const double exact = 2.0 * (1.0 + kNu) / 12.0 * 2.0;  // E I length
    std::vector<double> energy, error;
    for (const int cells : {3, 6}) {
        const Filled bar(shapes::box(Vec3(0, 0, 0), Vec3(1, 1, 2), cells, cells, 2 * cells), 1.5 / cells, kNu);
        auto problem = VolumeProblem::build(bar.input, {});
        REQUIRE(problem);
        const Eigen::MatrixXd held = bar.held(bent);
        const auto solution = problem->solve(held, {}, {});
        REQUIRE(solution);
        energy.push_back(std::abs(held.col(0).dot(solution->forces.col(0)) / exact - 1.0));
        error.push_back(bar.worst(*problem, solution->displacement, 0, bent));
    }
    const double byEnergy = std::log2(energy[0] / energy[1]), byError = std::log2(error[0] / error[1]);
    MESSAGE("energy ", energy[0], " ", energy[1], ", order ", byEnergy, "; displacement ", error[0], " ", error[1], ", order ", byError);
    CHECK(byEnergy > 0.9 * 2.0);
    CHECK(byError > 0.9 * 2.0);
}

TEST_CASE("volume problem: the same bytes for any number of threads, and clear refusals") {
    Filled bar(shapes::cylinder(0.5, 2.0, 12, 6), 0.4, 0.45);
    const Eigen::MatrixXd held = bar.held([](const Vec3& p) -> Vec3 { return Vec3(p.z() * p.y(), -p.z() * p.x(), 0.0); });
    Eigen::MatrixXd first;
    for (const int threads : {1, 4}) {
        bar.input.threads = threads;
        auto problem = VolumeProblem::build(bar.input, {});
        REQUIRE(problem);
        const auto solution = problem->solve(held.replicate(1, 30), {true, nullptr}, {});
        REQUIRE(solution);
        if (threads == 1)
            first = solution->displacement;
        else
            CHECK(first == solution->displacement);
        CHECK(problem->solve(held.topRows(3), {}, {}).error().code == "bad-value");
    }
    bar.input.nu = 0.5;
    CHECK(VolumeProblem::build(bar.input, {}).error().code == "bad-value");
    bar.input.nu = 0.3;
    std::stop_source stop;
    stop.request_stop();
    CHECK(VolumeProblem::build(bar.input, Progress({}, stop.get_token())).error().code == kCancelled);
    bar.input.held.clear();
    CHECK(VolumeProblem::build(bar.input, {}).error().code == "no-face");
}
