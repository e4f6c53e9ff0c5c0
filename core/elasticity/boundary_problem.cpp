// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/boundary_problem.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <new>
#include <numbers>
#include <optional>
#include <string>
#include <thread>

#include "core/base/clock.h"
#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/elasticity/boundary_input.h"
#include "core/elasticity/dense_lu.h"
#include "core/elasticity/kernels.h"
#include "core/elasticity/machine_rates.h"

namespace imomushi {
namespace {



/// Collocation points that a thread assembles between two looks at Progress::cancelled().
constexpr std::size_t kRowGrain = 4;
/// Of the full solid angle: rounding errors of the sums are 1e-13, an overlap is off by 1.
constexpr double kSolidAngleTolerance = 1e-6;
/// Refinement goes on while the residual shrinks by this factor ...
constexpr double kRefinementGain = 0.25;
/// ... and until it is at the rounding error of double precision.
constexpr double kResidualGoal = 1e-14;
constexpr int kMaxRefinements = 20;
/// Above this residual the solution is refused.
constexpr double kResidualLimit = 1e-6;
/// With a smaller reciprocal condition number the matrix is singular to single precision.
constexpr double kSingularRcond = 1e-9;

std::string gigabytes(std::size_t bytes) {
    const auto tenths = static_cast<long>(std::lround(static_cast<double>(bytes) / 1e8));
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " GB";
}

std::size_t matrixBytes(std::size_t freeVertices, std::size_t heldVertices) {
    const std::size_t n = 3 * (freeVertices + heldVertices);
    return n * n * sizeof(double) + n * 3 * heldVertices * sizeof(double) + DenseLu::bytesFor(static_cast<std::int32_t>(n));
}

constexpr const char* kNoUniqueAnswer =
    "The equations of this body have no unique answer; check that every separate part of it has a joint face and that no two vertices lie at "
    "the same point.";

/// Assembly over the time of its integrals: rows are cleared, sorted into the matrix and rounded to single precision.
constexpr double kAssemblyOverhead = 1.3;
/// Factorisation over the time of its products: panels, row exchanges, threads that wait at the end.
constexpr double kFactorOverhead = 1.3;
/// Integrals of one triangle with tractions, in pairs of the assembly.
constexpr double kTractionPairs = 2.0;
/// Solving and refining one of many columns, in flops per unknown squared: three rounds of two products, of which the one in double precision counts twice.
constexpr double kTractionFlops = 18.0;
/// Joint faces hold about this share of an element's vertices.
constexpr double kUsualHeldShare = 0.15;

}  // namespace

struct BoundaryProblem::State {
    std::unique_ptr<const BoundaryEquation> equation;
    std::size_t ld = 0;
    LargeArray<double> matrix;   ///< A by rows, n x n, n = 3 nodes
    LargeArray<double> heldH;    ///< H_J by rows, n x 3 held
    DenseLu lu;                  ///< of A^T: A by rows is A^T by columns
    int threads = 1;
    bool unheld = false;         ///< nothing holds a part of the body; reported after faults of the surface itself
    SolveQuality quality;

    [[nodiscard]] std::int32_t unknowns() const { return 3 * equation->nodes(); }
    [[nodiscard]] std::size_t denseBytes() const {
        const auto held = static_cast<std::size_t>(equation->heldCount());
        return matrixBytes(static_cast<std::size_t>(equation->nodes()) - held, held);
    }
    [[nodiscard]] Result<void> checkShare(std::int32_t node, double share) const;
    Result<double> assemble(const Progress& progress);
    Result<void> build(const Progress& progress);
    Result<Eigen::MatrixXd> solve(const Eigen::MatrixXd& held, const Loads& loads, const Progress& progress);
};

/// Compares the solid angle by the whole surface with that by the triangles around the node.
Result<void> BoundaryProblem::State::checkShare(std::int32_t node, double share) const {
    const std::string vertex = std::to_string(equation->vertexOf(node));
    if (!(share > -kSolidAngleTolerance && share < 1.0 + kSolidAngleTolerance))
        return fail("not-closed", "The surface is turned inside out or overlaps itself at vertex " + vertex + " (solid angle " + std::to_string(share) +
                                      " of a full sphere); repair the mesh.");
    if (std::abs(share - equation->localSolidAngle(node)) > kSolidAngleTolerance)
        return fail("not-closed", "The surface touches itself at vertex " + vertex + "; move the parts a little apart, or weld them.");
    return {};
}

/// Fills matrix, heldH and lu; returns the 1-norm of A^T (largest sum of magnitudes in a row of A).
Result<double> BoundaryProblem::State::assemble(const Progress& progress) {
    const auto count = static_cast<std::size_t>(equation->nodes()), held = static_cast<std::size_t>(equation->heldCount());
    const std::size_t displacements = count - held;
    std::vector<double> solidAngle(count), rowNorm(count);
    std::atomic<std::size_t> done{0};
    const std::thread::id builder = std::this_thread::get_id();
    parallelFor(threads, count, kRowGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        thread_local std::vector<double> h, g;
        h.resize(9 * (count + 1));
        g.resize(9 * held);
        for (std::size_t p = begin; p < end; ++p) {
            solidAngle[p] = equation->row(static_cast<std::int32_t>(p), h.data(), g.data());
            for (std::size_t k = 0; k < 3; ++k) {
                double* row = matrix.data() + (3 * p + k) * ld;
                double* heldRow = heldH.data() + (3 * p + k) * 3 * held;
                float* single = lu.column(static_cast<std::int32_t>(3 * p + k));
                for (std::size_t v = 0; v < displacements; ++v)
                    for (std::size_t l = 0; l < 3; ++l) row[3 * v + l] = h[9 * v + 3 * k + l];
                double* tractions = row + 3 * displacements;
                for (std::size_t v = 0; v < held; ++v)
                    for (std::size_t l = 0; l < 3; ++l) {
                        heldRow[3 * v + l] = h[9 * (displacements + v) + 3 * k + l];
                        tractions[3 * v + l] = g[9 * v + 3 * k + l];
                    }
                double norm = 0.0;
                for (std::size_t l = 0; l < 3 * count; ++l) {
                    single[l] = static_cast<float>(row[l]);
                    norm += std::abs(row[l]);
                }
                rowNorm[p] = std::max(rowNorm[p], norm);
            }
        }
        const std::size_t finished = done += end - begin;
        if (std::this_thread::get_id() == builder) progress.report("assemble", static_cast<double>(finished) / static_cast<double>(count));
    });
    if (progress.cancelled()) return fail(kCancelled, "The precompute was cancelled.");

    for (std::size_t p = 0; p < solidAngle.size(); ++p)
        if (auto ok = checkShare(static_cast<std::int32_t>(p), solidAngle[p]); !ok) return tl::make_unexpected(ok.error());
    const double norm = *std::max_element(rowNorm.begin(), rowNorm.end());
    if (!std::isfinite(norm)) return fail("bad-value", "The mesh gives integrals that are not finite; repair its degenerate triangles.");
    return norm;
}

Result<void> BoundaryProblem::check(const Input& input) {
    if (auto surface = heldSurface(input); !surface) return tl::make_unexpected(surface.error());
    return {};
}

Result<BoundaryProblem> BoundaryProblem::build(const Input& input, const Progress& progress) {
    const auto surface = heldSurface(input);
    if (!surface) return tl::make_unexpected(surface.error());
    const TriangleMesh& mesh = *input.mesh;
    auto state = std::make_unique<State>();
    state->threads = std::max(1, input.threads);
    state->equation = std::make_unique<const BoundaryEquation>(mesh, surface->edges, input.held, input.bubbles, input.nu);
    state->unheld = hasUnheldPart(mesh, *surface);
    if (auto ok = state->build(progress); !ok) return tl::make_unexpected(ok.error());
    return BoundaryProblem(std::move(state));
}

Result<void> BoundaryProblem::State::build(const Progress& progress) {
    const std::string noMemory = "Solving " + std::to_string(equation->nodes()) + " nodes needs " + gigabytes(denseBytes()) +
                                 " of memory, more than there is; use a coarser mesh or close other programs.";
    if (denseBytes() > availableMemory()) return fail("no-memory", noMemory);
    const std::int32_t n = unknowns();
    try {
        ld = static_cast<std::size_t>(n);
        matrix = LargeArray<double>(static_cast<std::size_t>(n) * ld);
        heldH = LargeArray<double>(static_cast<std::size_t>(n) * 3 * static_cast<std::size_t>(equation->heldCount()));
        lu = DenseLu(n);
        quality.peakBytes = denseBytes();

        // Shares of the time as estimated beforehand.
        const double pairs = static_cast<double>(equation->nodes()) * equation->triangles();
        const MachineRates rates = machineRates();
        const double assembly = rates.secondsPerPair * kAssemblyOverhead * pairs;
        const double factorisation = 2.0 / 3.0 * std::pow(n, 3) / rates.flops * kFactorOverhead;
        const double split = assembly / (assembly + factorisation);
        auto start = Clock::now();
        const auto norm = assemble(progress.part(0.0, split));
        if (!norm) return tl::make_unexpected(norm.error());
        if (unheld) return fail("singular", kNoUniqueAnswer);
        quality.assembleSeconds = secondsSince(start);
        start = Clock::now();
        const Progress factorising = progress.part(split, 1.0);
        const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
        if (!lu.factorise(threads, factorising)) return cancelled();
        if (!lu.reciprocalCondition(*norm, threads, factorising, quality.rcond)) return cancelled();
        quality.factoriseSeconds = secondsSince(start);
    } catch (const std::bad_alloc&) {
        return fail("no-memory", noMemory);
    }
    if (!(quality.rcond > kSingularRcond)) return fail("singular", kNoUniqueAnswer);
    return {};
}

Result<BoundaryProblem::Solution> BoundaryProblem::solve(const Eigen::MatrixXd& held, const Loads& loads, const Progress& progress) {
    State& s = *state_;
    if (held.rows() != 3 * s.equation->heldCount()) return fail("bad-value", "The displacements do not match the held vertices.");
    if (!allFinite(held)) return fail("bad-value", "A prescribed displacement is not finite.");
    if (loads.tractions && (loads.tractions->rows() != s.equation->vertices() || !allFinite(*loads.tractions)))
        return fail("bad-value", "The tractions do not match the vertices, or are not finite.");
    const auto start = Clock::now();
    auto x = s.solve(held, loads, progress);
    s.quality.solveSeconds += secondsSince(start);
    if (!x) return tl::make_unexpected(x.error());
    Solution solution;
    solution.displacement = x->topRows(3 * s.equation->freeCount());
    solution.bubbles = x->middleRows(3 * s.equation->freeCount(), 3 * s.equation->bubbleCount());
    solution.traction = x->bottomRows(3 * s.equation->heldCount());
    for (std::int32_t v = 0; v < s.equation->heldCount(); ++v) solution.traction.middleRows(3 * v, 3) *= s.equation->tractionScale(v);
    return solution;
}

Result<BoundaryProblem::Solution> BoundaryProblem::solve(const Eigen::MatrixXd& held, const Progress& progress) { return solve(held, Loads{}, progress); }

Result<Eigen::MatrixXd> BoundaryProblem::State::solve(const Eigen::MatrixXd& held, const Loads& loads, const Progress& progress) {
    const std::int32_t n = unknowns(), known = 3 * equation->heldCount();
    const auto prescribed = static_cast<std::int32_t>(held.cols());
    const auto k = static_cast<std::int32_t>(prescribed + loads.columns());
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };

    Eigen::MatrixXd right(n, k), x = Eigen::MatrixXd::Zero(n, k);
    if (!subtractProduct(heldH.data(), static_cast<std::size_t>(known), n, known, held.data(), prescribed, right.data(), true, threads, progress))
        return cancelled();
    if (loads.body) right.middleCols<BoundaryEquation::kLoads>(prescribed) = equation->loads(threads, progress);
    if (loads.tractions) right.rightCols(3 * loads.tractions->cols()) = equation->tractionLoads(*loads.tractions, threads, progress);
    if (progress.cancelled()) return cancelled();
    const Eigen::VectorXd rightNorm = right.colwise().norm();

    // The factors are in single precision: each step of refinement gains about five digits, in residuals of double precision.
    Eigen::MatrixXd residual = right;
    Eigen::MatrixXf step(n, k);
    double worst = 1.0;
    for (int round = 0; round < kMaxRefinements && worst > kResidualGoal; ++round) {
        Eigen::VectorXd norm = residual.colwise().norm();
        for (std::int32_t c = 0; c < k; ++c) step.col(c) = (residual.col(c) / (norm[c] > 0.0 ? norm[c] : 1.0)).cast<float>();
        if (!lu.solve(step.data(), k, true, threads, progress)) return cancelled();
        if (!allFinite(step)) break;
        Eigen::MatrixXd next = x + step.cast<double>() * norm.asDiagonal();
        Eigen::MatrixXd nextResidual = right;
        if (!subtractProduct(matrix.data(), ld, n, n, next.data(), k, nextResidual.data(), false, threads, progress)) return cancelled();
        double reached = 0.0;
        for (std::int32_t c = 0; c < k; ++c)
            if (rightNorm[c] > 0.0) reached = std::max(reached, nextResidual.col(c).norm() / rightNorm[c]);
        if (!(reached < worst)) break;  // at the limit of this matrix
        const bool gains = reached < kRefinementGain * worst;
        x.swap(next);
        residual.swap(nextResidual);
        worst = reached;
        progress.report("solve", std::min(1.0, std::log10(std::max(worst, kResidualGoal)) / std::log10(kResidualGoal)));
        if (!gains) break;
    }
    if (rightNorm.isZero(0.0)) worst = 0.0;
    quality.residual = std::max(quality.residual, worst);
    if (!(worst <= kResidualLimit))
        return fail("inaccurate", "The equations of this body are too ill-conditioned to be solved accurately; repair thin spikes and nearly "
                                 "coinciding surfaces, or remesh it more evenly.");
    return x;
}

BoundaryProblem::Estimate BoundaryProblem::estimate(int nodes, int triangles, int columns, int threads, int tractions) {
    Estimate out;
    if (nodes <= 0) return out;
    const MachineRates rates = machineRates();
    const double n = 3.0 * nodes, threadCount = std::clamp(threads, 1, hardwareThreads());
    const double pairs = static_cast<double>(nodes) * triangles;
    out.seconds = (rates.secondsPerPair * kAssemblyOverhead * pairs + 2.0 / 3.0 * n * n * n / rates.flops * kFactorOverhead) / threadCount;
    if (tractions > 0) out.seconds += rates.secondsPerPair * kTractionPairs * pairs / threadCount;
    // Estimating the condition (about ten triangles with one column), then solving and refining (three rounds), all bound by memory.
    const double passes = 10.0 * 2.0 * n * n + 3.0 * (4.0 + 8.0) * n * n;
    out.seconds += passes / rates.bytesPerSecond + (8.0 * 4.0 * columns + kTractionFlops * tractions) * n * n / (rates.flops * threadCount);
    const auto held = static_cast<std::size_t>(kUsualHeldShare * nodes);
    out.bytes = matrixBytes(static_cast<std::size_t>(nodes) - held, held) + 40 * static_cast<std::size_t>(n) * static_cast<std::size_t>(columns + tractions);
    return out;
}

BoundaryProblem::BoundaryProblem(std::unique_ptr<State> state) : state_(std::move(state)) {}
BoundaryProblem::BoundaryProblem(BoundaryProblem&&) noexcept = default;
BoundaryProblem& BoundaryProblem::operator=(BoundaryProblem&&) noexcept = default;
BoundaryProblem::~BoundaryProblem() = default;
const std::vector<std::int32_t>& BoundaryProblem::freeVertices() const { return state_->equation->freeVertices(); }
const SolveQuality& BoundaryProblem::quality() const { return state_->quality; }

}  // namespace imomushi
