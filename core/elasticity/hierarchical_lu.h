// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/hierarchical_matrix.h"

namespace imomushi {

/// Solves equations that are too large for a dense matrix: the matrix in hierarchical form for products, and a coarse hierarchical factorisation
/// (blocks off the diagonal of low rank on every level; Ambikasaran and Darve, J. Sci. Comput. 57 (2013) 477) as the preconditioner of GMRES. What
/// the approximation leaves is computed from the true entries, in double precision, and solved for again: the residual that is stated is the true
/// one, whatever the tolerance. Nothing is pivoted across blocks: it suits matrices as boundary equations are, whose diagonal dominates.
/// The same source gives the same bytes for any number of threads; `progress` is asked at least every 50 ms.
class HierarchicalLu {
public:
    struct Options {
        double tolerance = 1e-6;  ///< of the hierarchical matrix, see HierarchicalMatrix::Options; 1e-1...1e-7
        int threads = 1;
        std::size_t memoryLimit = ~std::size_t{0};  ///< bytes, everything together
    };
    /// Of build() and of the last solve().
    struct Quality {
        double residual = 0.0;      ///< largest |A x - b| / |b| over the columns (2-norms), A the true matrix, not its approximation
        int iterations = 0;         ///< of GMRES, all restarts together; the largest number over the columns
        int corrections = 0;        ///< how often the true residual was computed and solved for
        double assembleSeconds = 0.0, factoriseSeconds = 0.0, solveSeconds = 0.0;
        std::size_t matrixBytes = 0, factorBytes = 0, solveBytes = 0;
        double compression = 0.0;   ///< matrixBytes / bytes of the dense matrix in the same precision
    };
    /// What build() and a solve() with `columns` right-hand sides to a residual of `goal` need together, from samples that are computed now (a few %
    /// of the whole). Seconds are those of a machine that has nothing else to do.
    struct Estimate {
        double seconds = 0.0;
        std::size_t bytes = 0;
    };
    static Result<Estimate> estimate(const BlockSource& source, const Options& options, std::int32_t columns, double goal, const Progress& progress);

    /// Errors: "cancelled", "no-memory", "bad-value" (an entry is not finite), "singular".
    static Result<HierarchicalLu> build(std::shared_ptr<const BlockSource> source, const Options& options, const Progress& progress);

    HierarchicalLu(HierarchicalLu&&) noexcept;
    HierarchicalLu& operator=(HierarchicalLu&&) noexcept;
    ~HierarchicalLu();

    /// Replaces the right-hand sides x (3 #nodes x any number of columns; unknown 3 i + k is axis k of node i) by the solutions with a residual of
    /// at most `goal` (see Quality; above 1e-13), or leaves x as it was.
    /// Errors: "cancelled", "bad-value", "no-memory", "inaccurate" (goal not reached).
    Result<void> solve(Eigen::MatrixXd& x, double goal, const Progress& progress);

    [[nodiscard]] const Quality& quality() const;
    [[nodiscard]] const HierarchicalMatrix& matrix() const;

private:
    struct State;
    explicit HierarchicalLu(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
