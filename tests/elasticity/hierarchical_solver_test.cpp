// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hierarchical_solver.h"

#include <doctest/doctest.h>
#include <lapacke.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stop_token>
#include <string>

#include "core/elasticity/boundary_equation.h"
#include "core/elasticity/dense_lu.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

shapes::Body cube(int n) { return shapes::box({-0.5, -0.5, 0.0}, {0.5, 0.5, 1.0}, n, n, n); }
/// Hundred times wider than thick: nearly all triangles lie in two planes, and near ones are far apart along the surface.
shapes::Body plate(int n) { return shapes::box({-0.5, -0.005, 0.0}, {0.5, 0.005, 1.0}, n, 1, n); }

/// The boundary equations of a body held at its ends; counts how often entries are asked for.
class CountingSource : public BlockSource {
public:
    CountingSource(const shapes::Body& body, double nu, bool quadratic) : equation_(body.mesh, heldOf(body), bubblesOf(body, quadratic), nu) {
        for (const auto& end : body.ends)
            for (const std::int32_t v : end.vertices) heldAt_.push_back(body.mesh.vertices.row(v).transpose());
        firstEnd_ = body.ends[0].vertices.size();
    }
    [[nodiscard]] std::int32_t nodes() const override { return equation_.nodes(); }
    [[nodiscard]] Vec3 position(std::int32_t node) const override { return equation_.position(node); }
    [[nodiscard]] Box support(std::int32_t node) const override { return equation_.support(node); }
    [[nodiscard]] std::unique_ptr<Columns> columns(std::span<const std::int32_t> nodes) const override {
        struct Counted : Columns {
            std::unique_ptr<Columns> inner;
            std::atomic<std::int64_t>& count;
            Counted(std::unique_ptr<Columns> i, std::atomic<std::int64_t>& c) : inner(std::move(i)), count(c) {}
            void rows(std::span<const std::int32_t> rowNodes, double* out) const override {
                ++count;
                inner->rows(rowNodes, out);
            }
        };
        return std::make_unique<Counted>(equation_.columns(nodes), asked_);
    }
    [[nodiscard]] std::int64_t asked() const { return asked_; }

    /// One end moved and turned by some random rigid motions, the other one still.
    [[nodiscard]] Eigen::MatrixXd someRightHandSides(int columns) const {
        std::mt19937 random(1);
        const auto number = [&] { return static_cast<double>(random()) * 0x1p-32 - 0.5; };
        Eigen::MatrixXd held = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(heldAt_.size()), columns);
        for (int c = 0; c < columns; ++c) {
            const Vec3 shift(number(), number(), number()), turn(number(), number(), number());
            for (std::size_t j = firstEnd_; j < heldAt_.size(); ++j) {
                const Vec3& p = heldAt_[j];
                held.col(c).segment<3>(static_cast<Eigen::Index>(3 * j)) =
                    shift + Vec3(turn[1] * p[2] - turn[2] * p[1], turn[2] * p[0] - turn[0] * p[2], turn[0] * p[1] - turn[1] * p[0]);
            }
        }
        return equation_.rightHandSides(held, 1, {});
    }

private:
    static std::vector<HeldPatch> heldOf(const shapes::Body& body) {
        std::vector<HeldPatch> out;
        for (const auto& end : body.ends) out.push_back({end.vertices, end.triangles});
        return out;
    }
    /// All edges between triangles that are not held.
    static std::vector<std::array<std::int32_t, 2>> bubblesOf(const shapes::Body& body, bool wanted) {
        std::vector<std::array<std::int32_t, 2>> out;
        if (!wanted) return out;
        std::vector<char> held(static_cast<std::size_t>(body.mesh.triangles.rows()));
        for (const auto& end : body.ends)
            for (const std::int32_t f : end.triangles) held[static_cast<std::size_t>(f)] = 1;
        const EdgeTable edges(body.mesh.triangles);
        for (int e = 0; e < edges.size(); ++e) {
            const auto uses = edges.uses(e);
            if (!held[static_cast<std::size_t>(uses[0].triangle)] && !held[static_cast<std::size_t>(uses[1].triangle)])
                out.push_back({uses[0].low, uses[0].high});
        }
        return out;
    }

    BoundaryEquation equation_;
    std::vector<Vec3> heldAt_;
    std::size_t firstEnd_ = 0;
    mutable std::atomic<std::int64_t> asked_{0};
};

std::shared_ptr<CountingSource> sourceOf(const shapes::Body& body, double nu, bool quadratic = false) {
    return std::make_shared<CountingSource>(body, nu, quadratic);
}

Eigen::MatrixXd denseMatrix(const BlockSource& source) {
    std::vector<std::int32_t> all(static_cast<std::size_t>(source.nodes()));
    for (std::int32_t i = 0; i < source.nodes(); ++i) all[static_cast<std::size_t>(i)] = i;
    Eigen::MatrixXd a(3 * source.nodes(), 3 * source.nodes());
    source.columns(all)->rows(all, a.data());
    return a;
}

Eigen::MatrixXd inverse(Eigen::MatrixXd a) {
    useSingleThreadedBlas();
    const auto n = static_cast<int>(a.rows());
    std::vector<int> pivots(static_cast<std::size_t>(n));
    REQUIRE(LAPACKE_dgetrf(LAPACK_COL_MAJOR, n, n, a.data(), n, pivots.data()) == 0);
    REQUIRE(LAPACKE_dgetri(LAPACK_COL_MAJOR, n, a.data(), n, pivots.data()) == 0);
    return a;
}

/// Points on a line, each coupled to all others by c / distance^2, on top of a diagonal; entry (0, 0) and c can be anything.
class LineSource : public BlockSource {
public:
    LineSource(std::int32_t count, double diagonal, double coupling) : count_(count), diagonal_(diagonal), coupling_(coupling) {}
    [[nodiscard]] std::int32_t nodes() const override { return count_; }
    [[nodiscard]] Vec3 position(std::int32_t node) const override { return {static_cast<double>(node), 0.0, 0.0}; }
    [[nodiscard]] Box support(std::int32_t node) const override { return {position(node), position(node)}; }
    [[nodiscard]] std::unique_ptr<Columns> columns(std::span<const std::int32_t> nodes) const override {
        struct Some : Columns {
            const LineSource& source;
            std::vector<std::int32_t> nodes;
            Some(const LineSource& s, std::span<const std::int32_t> n) : source(s), nodes(n.begin(), n.end()) {}
            void rows(std::span<const std::int32_t> rowNodes, double* out) const override {
                for (const std::int32_t j : nodes)
                    for (int l = 0; l < 3; ++l)
                        for (const std::int32_t i : rowNodes)
                            for (int k = 0; k < 3; ++k) {
                                const double distance = i - j;
                                *out++ = i == j ? (k == l ? source.diagonal_ : 0.0) : source.coupling_ / (distance * distance);
                            }
            }
        };
        return std::make_unique<Some>(*this, nodes);
    }

private:
    std::int32_t count_;
    double diagonal_, coupling_;
};

std::size_t needed(const HierarchicalSolver::Quality& q) { return q.matrixBytes + q.factorBytes + q.solveBytes; }

}  // namespace

TEST_CASE("hierarchical solution: the true residual is what was asked for, and the error what that allows") {
    for (const auto& source : {sourceOf(cube(9), 0.3), sourceOf(plate(16), 0.4999), sourceOf(cube(5), 0.45, true)}) {
        const Eigen::MatrixXd a = denseMatrix(*source), inverted = inverse(a), b = source->someRightHandSides(5);
        const Eigen::MatrixXd exact = inverted * b;
        auto solver = HierarchicalSolver::build(source, {.tolerance = 1e-5, .threads = 2}, {});
        REQUIRE(solver);
        for (const double goal : {1e-4, 1e-9}) {
            CAPTURE(goal);
            Eigen::MatrixXd x = b;
            REQUIRE(solver->solve(x, goal, {}));
            const Eigen::MatrixXd residual = a * x - b;
            for (Eigen::Index c = 0; c < b.cols(); ++c) {
                // Sums of 3 N terms in another order differ by rounding.
                CHECK(residual.col(c).norm() <= goal * b.col(c).norm() + 1e-13 * a.norm() * x.col(c).norm());
                CHECK((x - exact).col(c).norm() <= inverted.norm() * goal * b.col(c).norm());
            }
            CHECK(solver->quality().residual <= goal);
        }
    }
}

TEST_CASE("hierarchical solution: a right-hand side of zeros has the solution zero, among others too") {
    const auto source = sourceOf(cube(7), 0.3);
    auto solver = HierarchicalSolver::build(source, {}, {});
    REQUIRE(solver);
    Eigen::MatrixXd x = source->someRightHandSides(3);
    x.col(1).setZero();
    REQUIRE(solver->solve(x, 1e-6, {}));
    CHECK(x.col(1).isZero(0.0));
    CHECK(!x.col(0).isZero(0.0));
    x.setZero();
    REQUIRE(solver->solve(x, 1e-6, {}));
    CHECK(x.isZero(0.0));
}

TEST_CASE("blocks of low rank: patches in one plane, that hardly see each other, are approximated as well as others") {
    constexpr double kTolerance = 1e-6;
    for (const auto& source : {sourceOf(cube(13), 0.45), sourceOf(plate(24), 0.45), sourceOf(plate(14), 0.45, true)}) {
        const auto matrix = HierarchicalMatrix::build(*source, {.tolerance = kTolerance, .threads = 2}, {});
        REQUIRE(matrix);
        const auto& order = matrix->tree().order();
        double sum = 0.0;
        std::size_t low = 0;
        for (const auto& block : matrix->blocks()) {
            if (block.rank < 0) continue;
            ++low;
            const std::int32_t m = block.rowEnd - block.rowBegin, n = block.columnEnd - block.columnBegin;
            Eigen::MatrixXd entries(3 * m, 3 * n);
            source->columns(std::span(order).subspan(static_cast<std::size_t>(block.columnBegin), static_cast<std::size_t>(n)))
                ->rows(std::span(order).subspan(static_cast<std::size_t>(block.rowBegin), static_cast<std::size_t>(m)), entries.data());
            if (block.rank > 0)
                entries -= Eigen::Map<const Eigen::MatrixXf>(block.u.get(), 3 * m, block.rank).cast<double>() *
                           Eigen::Map<const Eigen::MatrixXf>(block.v.get(), 3 * n, block.rank).cast<double>().transpose();
            const double allowed = kTolerance * matrix->rowScale() * std::sqrt(3.0 * m * n / static_cast<double>(order.size()));
            CHECK(entries.norm() <= 10.0 * allowed);  // found by samples: a single block may miss, a trap misses by hundreds
            sum += entries.squaredNorm();
        }
        CHECK(low > 100);
        CHECK(std::sqrt(sum) <= 1.5 * kTolerance * matrix->rowScale() * std::sqrt(3.0 * static_cast<double>(order.size())));
    }
}

TEST_CASE("hierarchical product: all blocks together are the matrix, and transposed its transpose") {
    const auto source = sourceOf(cube(9), 0.45);
    const auto matrix = HierarchicalMatrix::build(*source, {.tolerance = 1e-6, .threads = 1}, {});
    REQUIRE(matrix);
    const auto& order = matrix->tree().order();
    const Eigen::MatrixXd unsorted = denseMatrix(*source);
    const auto n = static_cast<std::int32_t>(unsorted.rows());
    Eigen::MatrixXd a(n, n);
    for (std::int32_t i = 0; i < n; ++i)
        for (std::int32_t j = 0; j < n; ++j)
            a(i, j) = unsorted(3 * order[static_cast<std::size_t>(i / 3)] + i % 3, 3 * order[static_cast<std::size_t>(j / 3)] + j % 3);
    Eigen::MatrixXf x(n, 3);
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = static_cast<float>(std::sin(static_cast<double>(i * i)));
    Eigen::MatrixXd y(n, 3);
    for (const bool transposed : {false, true}) {
        REQUIRE(matrix->multiply(matrix->blocks(), x.data(), y.data(), 3, transposed, 2, {}));
        const Eigen::MatrixXd expected = transposed ? (a.transpose() * x.cast<double>()).eval() : (a * x.cast<double>()).eval();
        CHECK((y - expected).norm() <= 1e-5 * expected.norm());
    }
}

TEST_CASE("hierarchical solution: the same bytes for any number of threads") {
    const auto source = sourceOf(cube(11), 0.45);
    const Eigen::MatrixXd b = source->someRightHandSides(4);
    Eigen::MatrixXd first;
    for (const int threads : {1, 2, 5}) {
        auto solver = HierarchicalSolver::build(source, {.threads = threads}, {});
        REQUIRE(solver);
        Eigen::MatrixXd x = b;
        REQUIRE(solver->solve(x, 1e-7, {}));
        if (threads == 1) first = x;
        CHECK(std::memcmp(x.data(), first.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0);
    }
}

TEST_CASE("hierarchical solution: cancelling is noticed within one step of one block, at every stage") {
    const auto source = sourceOf(cube(13), 0.3);
    constexpr int kThreads = 2;
    // A step of one approximation asks for a row, three columns, and rows to check.
    constexpr std::int64_t kCallsPerStep = 16;
    for (const auto& [stage, fraction] : {std::pair{"assemble", 0.0}, std::pair{"assemble", 0.6}, std::pair{"factorise", 0.0}, std::pair{"solve", 0.0}}) {
        CAPTURE(stage);
        std::stop_source stop;
        std::int64_t asked = -1;
        int reports = 0;
        const Progress progress(
            [&, stage = std::string(stage), fraction = fraction](std::string_view now, double f) {
                if (asked >= 0) ++reports;
                if (asked < 0 && now == stage && f >= fraction) {
                    stop.request_stop();
                    asked = source->asked();
                }
            },
            stop.get_token());
        auto solver = HierarchicalSolver::build(source, {.threads = kThreads}, progress);
        std::string code = solver ? "" : solver.error().code;
        if (solver) {
            Eigen::MatrixXd x = source->someRightHandSides(2);
            const Eigen::MatrixXd before = x;
            const auto solved = solver->solve(x, 1e-6, progress);
            code = solved ? "" : solved.error().code;
            CHECK(x == before);
        }
        CHECK(code == kCancelled);
        REQUIRE(asked >= 0);
        CHECK(source->asked() - asked <= kThreads * kCallsPerStep);
        CHECK(reports <= 1);
    }
}

TEST_CASE("hierarchical solution: what does not fit into the memory allowed is refused with the reason") {
    const auto source = sourceOf(cube(11), 0.3);
    const auto hopeless = HierarchicalSolver::build(source, {.memoryLimit = 1'000'000}, {});
    REQUIRE(!hopeless);
    CHECK(hopeless.error().code == "no-memory");
    CHECK(source->asked() == 0);

    const auto enough = HierarchicalSolver::build(source, {.threads = 2}, {});
    REQUIRE(enough);
    const auto tight = HierarchicalSolver::build(source, {.threads = 2, .memoryLimit = enough->quality().matrixBytes}, {});
    REQUIRE(!tight);
    CHECK(tight.error().code == "no-memory");
}

TEST_CASE("hierarchical solution: the estimate of memory comes before and is right within a factor of 1.5") {
    for (const auto& source : {sourceOf(cube(13), 0.45), sourceOf(plate(22), 0.45)}) {
        const auto estimate = HierarchicalSolver::estimate(*source, {.threads = 2}, 2, 1e-4, {});
        REQUIRE(estimate);
        CHECK(estimate->seconds > 0.0);
        auto solver = HierarchicalSolver::build(source, {.threads = 2}, {});
        REQUIRE(solver);
        Eigen::MatrixXd x = source->someRightHandSides(2);
        REQUIRE(solver->solve(x, 1e-4, {}));
        const double ratio = static_cast<double>(estimate->bytes) / static_cast<double>(needed(solver->quality()));
        CHECK(ratio > 1.0 / 1.5);
        CHECK(ratio < 1.5);
    }
}

TEST_CASE("hierarchical solution: few nodes, and nodes in one place, are no special case") {
    for (const std::int32_t count : {1, 2, 47, 49, 300}) {
        CAPTURE(count);
        const auto source = std::make_shared<LineSource>(count, 1.0, 0.05);
        auto solver = HierarchicalSolver::build(source, {}, {});
        REQUIRE(solver);
        Eigen::MatrixXd b = Eigen::MatrixXd::Ones(3 * count, 1), x = b;
        REQUIRE(solver->solve(x, 1e-10, {}));
        CHECK((denseMatrix(*source) * x - b).norm() <= 2e-10 * b.norm());
    }
}

TEST_CASE("hierarchical solution: a singular matrix, and numbers that are none, are refused") {
    const auto singular = HierarchicalSolver::build(std::make_shared<LineSource>(300, 0.0, 0.0), {}, {});
    REQUIRE(!singular);
    CHECK(singular.error().code == "singular");

    const auto broken = HierarchicalSolver::build(std::make_shared<LineSource>(300, 1.0, std::numeric_limits<double>::quiet_NaN()), {}, {});
    REQUIRE(!broken);
    CHECK(broken.error().code == "bad-value");

    auto solver = HierarchicalSolver::build(std::make_shared<LineSource>(10, 1.0, 0.01), {}, {});
    REQUIRE(solver);
    Eigen::MatrixXd x = Eigen::MatrixXd::Constant(30, 1, std::numeric_limits<double>::infinity());
    CHECK(solver->solve(x, 1e-6, {}).error().code == "bad-value");
    x = Eigen::MatrixXd::Ones(29, 1);
    CHECK(solver->solve(x, 1e-6, {}).error().code == "bad-value");
}
