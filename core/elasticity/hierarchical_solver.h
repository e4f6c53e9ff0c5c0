// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/hierarchical_matrix.h"

namespace imomushi {

/// Solves systems that are too large for a dense matrix: GMRES on a hierarchical matrix (HierarchicalMatrix) with a HODLR preconditioner
/// (HodlrFactorisation), inside an iterative refinement whose residuals come from the exact entries of A in double precision. The residual that is
/// stated is therefore the exact one, whatever the tolerance of the hierarchical matrix. For matrices with a dominant diagonal, as those of boundary
/// equations are.
/// The same source gives the same bytes for any number of threads; `progress` is asked at least every 50 ms.
class HierarchicalSolver {
public:
    struct Options {
        double tolerance = 1e-6;  ///< of the hierarchical matrix, see HierarchicalMatrix::Options; 1e-1...1e-7
        int threads = 1;
        std::size_t memoryLimit = ~std::size_t{0};  ///< bytes, everything together
    };
    /// Of build() and of the last solve().
    struct Quality {
        double residual = 0.0;      ///< largest |A x - b| / |b| over the columns (2-norms), A with its exact entries
        int iterations = 0;         ///< of GMRES, all restarts together; the largest number over the columns
        int corrections = 0;        ///< rounds of iterative refinement
        double assembleSeconds = 0.0, factoriseSeconds = 0.0, solveSeconds = 0.0;
        std::size_t matrixBytes = 0, factorBytes = 0, solveBytes = 0;
        double compression = 0.0;   ///< matrixBytes / bytes of the dense matrix in the same precision
    };
    /// What build() and a solve() with `columns` right-hand sides to a residual of `goal` need together, from sampled blocks (which take a few % of the
    /// whole). Seconds are those of an idle machine.
    struct Estimate {
        double seconds = 0.0;
        std::size_t bytes = 0;
    };
    static Result<Estimate> estimate(const BlockSource& source, const Options& options, std::int32_t columns, double goal, const Progress& progress);

    /// Errors: "cancelled", "no-memory", "bad-value" (an entry is not finite), "singular".
    static Result<HierarchicalSolver> build(std::shared_ptr<const BlockSource> source, const Options& options, const Progress& progress);

    HierarchicalSolver(HierarchicalSolver&&) noexcept;
    HierarchicalSolver& operator=(HierarchicalSolver&&) noexcept;
    ~HierarchicalSolver();

    /// Replaces the right-hand sides x (3 #nodes x any number of columns; unknown 3 i + k is axis k of node i) by the solutions with a residual of
    /// at most `goal` (see Quality; above 1e-13), or leaves x as it was.
    /// Errors: "cancelled", "bad-value", "no-memory", "inaccurate" (goal not reached).
    Result<void> solve(Eigen::MatrixXd& x, double goal, const Progress& progress);

    [[nodiscard]] const Quality& quality() const;
    [[nodiscard]] const HierarchicalMatrix& matrix() const;

private:
    struct State;
    explicit HierarchicalSolver(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
