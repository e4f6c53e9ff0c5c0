// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/hierarchical_solver.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <vector>

#include "core/base/clock.h"
#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/elasticity/dense_lu.h"
#include "core/elasticity/gmres.h"
#include "core/elasticity/hodlr_factorisation.h"

namespace imomushi {

namespace {



/// A correction that gains less than this factor has met the limit of double precision.
constexpr double kWorthwhileRefinement = 0.7;
/// Exact entries are computed in blocks of so many nodes.
constexpr std::int32_t kResidualRows = 64, kResidualColumns = 1024;
/// GMRES goes on to this share of the hierarchical matrix's own error; beyond, only the next correction gains.
constexpr double kInnerShare = 0.5;
constexpr int kCorrections = 8;

Error wasCancelled() { return {kCancelled, "The precompute was cancelled."}; }

Error noMemory(std::int32_t nodes, std::size_t bytes) {
    const auto tenths = std::to_string(std::lround(static_cast<double>(bytes) / 1e8));
    const std::string size = bytes == 0 ? std::string("more memory than there is")
                                        : (tenths.size() > 1 ? tenths.substr(0, tenths.size() - 1) : std::string("0")) + "." + tenths.back() +
                                              " GB of memory, more than there is";
    return {"no-memory", "Solving " + std::to_string(nodes) + " vertices in compressed form needs " + size +
                             "; use a coarser mesh or close other programs."};
}

}  // namespace

struct HierarchicalSolver::State {
    std::shared_ptr<const BlockSource> source;
    Options options;
    HierarchicalMatrix matrix;
    HodlrFactorisation preconditioner;
    Quality quality;

    std::vector<std::unique_ptr<BlockSource::Columns>> columnBlocks;  ///< all columns, in the order of the tree
    std::size_t workBytes = 0;

    /// residual := right - A x with the exact entries of A, in the order of the tree. False: cancelled.
    bool trueResidual(const Eigen::MatrixXd& right, const Eigen::MatrixXd& x, Eigen::MatrixXd& residual, const Progress& progress);
};

bool HierarchicalSolver::State::trueResidual(const Eigen::MatrixXd& right, const Eigen::MatrixXd& x, Eigen::MatrixXd& residual,
                                         const Progress& progress) {
    const std::vector<std::int32_t>& order = matrix.tree().order();
    const auto nodes = static_cast<std::int32_t>(order.size());
    const auto columns = static_cast<std::int32_t>(x.cols());
    const auto nodesOf = [&](std::int32_t begin, std::int32_t count) {
        return std::span(order).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(std::min(count, nodes - begin)));
    };
    if (columnBlocks.empty()) {
        columnBlocks.resize(static_cast<std::size_t>((nodes + kResidualColumns - 1) / kResidualColumns));
        parallelFor(options.threads, columnBlocks.size(), 1, [&](std::size_t p, std::size_t) {
            if (!progress.cancelled()) columnBlocks[p] = source->columns(nodesOf(static_cast<std::int32_t>(p) * kResidualColumns, kResidualColumns));
        });
        if (progress.cancelled()) {
            columnBlocks.clear();
            return false;
        }
    }
    residual = right;
    const auto tasks = static_cast<std::size_t>((nodes + kResidualRows - 1) / kResidualRows);
    parallelFor(options.threads, tasks, 1, [&](std::size_t task, std::size_t) {
        const std::int32_t row = static_cast<std::int32_t>(task) * kResidualRows;
        const auto rows = nodesOf(row, kResidualRows);
        thread_local std::vector<double> entries;
        entries.resize(static_cast<std::size_t>(9) * kResidualRows * kResidualColumns);
        for (std::size_t p = 0; p < columnBlocks.size(); ++p) {
            if (progress.cancelled()) return;
            columnBlocks[p]->rows(rows, entries.data());
            const std::int32_t column = static_cast<std::int32_t>(p) * kResidualColumns, height = 3 * static_cast<std::int32_t>(rows.size());
            cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, height, columns, 3 * std::min(kResidualColumns, nodes - column), -1.0, entries.data(),
                        height, x.data() + 3 * column, static_cast<int>(x.rows()), 1.0, residual.data() + 3 * row, static_cast<int>(residual.rows()));
        }
    });
    return !progress.cancelled();
}

Result<HierarchicalSolver::Estimate> HierarchicalSolver::estimate(const BlockSource& source, const Options& options, std::int32_t columns, double goal,
                                                          const Progress& progress) {
    const std::int32_t nodes = source.nodes();
    auto matrix = HierarchicalMatrix::estimate(source, {.tolerance = options.tolerance, .threads = options.threads}, progress);
    if (!matrix) return tl::make_unexpected(matrix.error());
    Estimate out;
    const double n = 3.0 * nodes, threads = std::clamp(options.threads, 1, hardwareThreads()), g = std::max(columns, 1);
    out.bytes = matrix->bytes + HodlrFactorisation::estimateBytes(nodes) +
                std::max(HodlrFactorisation::estimateWorkBytes(nodes, matrix->ranks), gmresBytes(nodes, matrix->ranks) + static_cast<std::size_t>(40.0 * n * g));
    // Every stored entry is used once per step of GMRES and column; every exact entry is computed for each correction.
    const double entries = static_cast<double>(matrix->bytes) / sizeof(float);
    const double rate = measureProductRate() * threads;
    const double factorising = HodlrFactorisation::estimateFlops(nodes, entries);
    // Measured: the first solution of a compact body misses by several times the tolerance, one correction brings nearly the square of that, in about ten
    // steps. Thin bodies take one correction and about fifty steps more. These numbers lie between both.
    const double corrections = goal >= 8.0 * options.tolerance ? 1.5 : 2.5, steps = 40.0;
    constexpr double kSlower = 2.0;  // narrow products reach about half of the rate
    const double solving = steps * g * 2.0 * (entries + static_cast<double>(HodlrFactorisation::estimateBytes(nodes)) / sizeof(float)) +
                           corrections * g * 2.0 * 2.0 * n * n;  // in double precision
    out.seconds += corrections * matrix->secondsPerEntry * n * n / threads;
    out.seconds += matrix->seconds + kSlower * (factorising + solving) / rate;
    return out;
}

Result<HierarchicalSolver> HierarchicalSolver::build(std::shared_ptr<const BlockSource> source, const Options& options, const Progress& progress) {
    useSingleThreadedBlas();
    const std::int32_t nodes = source->nodes();
    if (nodes == 0) return fail("bad-value", "There is nothing to solve.");
    auto state = std::make_unique<State>();
    state->source = source;
    state->options = options;
    state->options.threads = std::max(1, options.threads);
    const std::size_t others = HodlrFactorisation::estimateBytes(nodes) + std::max(HodlrFactorisation::estimateWorkBytes(nodes, 0), gmresBytes(nodes, 0));
    if (others > options.memoryLimit) return tl::make_unexpected(noMemory(nodes, others));
    try {
        auto start = Clock::now();
        auto matrix = HierarchicalMatrix::build(
            *source, {.tolerance = options.tolerance, .threads = state->options.threads, .memoryLimit = options.memoryLimit - others},
            progress.part(0.0, 0.8));
        if (!matrix) return tl::make_unexpected(matrix.error());
        state->matrix = std::move(*matrix);
        state->workBytes = gmresBytes(nodes, state->matrix.ranks());
        Quality& q = state->quality;
        q.assembleSeconds = secondsSince(start);
        q.matrixBytes = state->matrix.bytes();
        q.compression = static_cast<double>(q.matrixBytes) / (36.0 * nodes * nodes);
        start = Clock::now();
        if (!state->preconditioner.build(state->matrix, state->options.threads, progress.part(0.8, 1.0))) return tl::make_unexpected(wasCancelled());
        q.factoriseSeconds = secondsSince(start);
        q.factorBytes = state->preconditioner.bytes();
    } catch (const std::bad_alloc&) {
        return tl::make_unexpected(noMemory(nodes, 0));
    }
    if (state->preconditioner.singular())
        return fail("singular", "The equations of this body have no unique answer; check that every separate part of it has a joint face and that no "
                                "two vertices lie at the same point.");
    return HierarchicalSolver(std::move(state));
}

Result<void> HierarchicalSolver::solve(Eigen::MatrixXd& x, double goal, const Progress& progress) {
    State& s = *state_;
    const std::int32_t n = s.matrix.size();
    if (x.rows() != n) return fail("bad-value", "The right-hand sides do not match the equations.");
    if (!allFinite(x)) return fail("bad-value", "A right-hand side is not finite.");
    const auto start = Clock::now();
    const std::vector<std::int32_t>& order = s.matrix.tree().order();
    const auto k = static_cast<std::int32_t>(x.cols());
    const auto cancelled = [] { return tl::make_unexpected(wasCancelled()); };
    double worst = 1.0;
    s.quality.residual = 0.0;
    s.quality.iterations = s.quality.corrections = 0;
    try {
        Eigen::MatrixXd right(n, k), solution = Eigen::MatrixXd::Zero(n, k), residual;
        for (std::int32_t i = 0; i < n / 3; ++i) right.middleRows(3 * i, 3) = x.middleRows(3 * order[static_cast<std::size_t>(i)], 3);
        const Eigen::VectorXd rightNorm = right.colwise().norm();
        if (rightNorm.isZero(0.0)) {
            x.setZero();
            return {};
        }
        residual = right;
        s.quality.solveBytes = std::max(s.quality.solveBytes, s.workBytes + 40 * static_cast<std::size_t>(n) * static_cast<std::size_t>(k));
        const auto reached = [&](double left) { return std::clamp(std::log(std::min(left, 1.0)) / std::log(goal), 0.0, 1.0); };
        for (int round = 0; round < kCorrections && worst > goal; ++round) {
            const double inner = std::clamp(0.25 * goal / worst, kInnerShare * s.options.tolerance, 0.1);
            const double from = reached(worst), to = reached(worst * inner);
            Eigen::MatrixXd next = solution;
            int iterations = 0;
            for (std::int32_t begin = 0; begin < k; begin += kGmresColumns) {
                const std::int32_t count = std::min(kGmresColumns, k - begin);
                Eigen::MatrixXd part = residual.middleCols(begin, count), step;
                int steps = 0;
                const double share = (to - from) / k;
                const Progress batch = progress.part(from + share * begin, from + share * (begin + count));
                if (!gmres(s.matrix, s.preconditioner, part, step, inner, steps, s.options.threads, batch)) return cancelled();
                next.middleCols(begin, count) += step;
                iterations = std::max(iterations, steps);
            }
            s.quality.iterations += iterations;
            Eigen::MatrixXd nextResidual;
            if (!s.trueResidual(right, next, nextResidual, progress)) return cancelled();
            double left = 0.0;
            for (std::int32_t c = 0; c < k; ++c)
                if (rightNorm[c] > 0.0) left = std::max(left, nextResidual.col(c).norm() / rightNorm[c]);
            if (!(left < worst)) break;
            const bool gains = left < kWorthwhileRefinement * worst;
            worst = left;
            solution.swap(next);
            residual.swap(nextResidual);
            ++s.quality.corrections;
            progress.report("solve", reached(worst));
            if (!gains) break;
        }
        s.quality.residual = worst;
        s.quality.solveSeconds = secondsSince(start);
        if (!(worst <= goal))
            return fail("inaccurate", "The equations of this body are too ill-conditioned to be solved accurately; repair thin spikes and nearly "
                                      "coinciding surfaces, or remesh it more evenly.");
        for (std::int32_t i = 0; i < n / 3; ++i) x.middleRows(3 * order[static_cast<std::size_t>(i)], 3) = solution.middleRows(3 * i, 3);
    } catch (const std::bad_alloc&) {
        return tl::make_unexpected(noMemory(n / 3, 0));
    }
    return {};
}

HierarchicalSolver::HierarchicalSolver(std::unique_ptr<State> state) : state_(std::move(state)) {}
HierarchicalSolver::HierarchicalSolver(HierarchicalSolver&&) noexcept = default;
HierarchicalSolver& HierarchicalSolver::operator=(HierarchicalSolver&&) noexcept = default;
HierarchicalSolver::~HierarchicalSolver() = default;
const HierarchicalSolver::Quality& HierarchicalSolver::quality() const { return state_->quality; }
const HierarchicalMatrix& HierarchicalSolver::matrix() const { return state_->matrix; }

}  // namespace imomushi
