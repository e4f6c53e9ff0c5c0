// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

namespace imomushi {

/// Cholesky factorisation of a sparse symmetric positive definite matrix of dense blocks whose pattern is known beforehand (one block row per joint point or
/// joint). The constructor finds a minimum-degree order and the fill (George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981);
/// assembling, factorising and solving then allocate nothing, which frames need. Eigen's SimplicialLLT and CHOLMOD would copy the permuted matrix in every
/// factorisation, and treat the blocks entry by entry.
///
/// blockSize: 3, factorised as L D L^T with explicitly inverted 3 x 3 pivots, so that solving needs products only; or Eigen::Dynamic for blocks of
/// different sizes, factorised as L L^T.
template <int blockSize>
class BlockCholesky {
public:
    using Block = Eigen::Matrix<double, blockSize, blockSize>;
    using Vector = Eigen::Matrix<double, blockSize, 1>;

    BlockCholesky() = default;
    /// sizes: rows of each block row (all 3 where blockSize is 3; 0 is allowed where it is not). pairs: the off-diagonal blocks that may be non-zero, in any
    /// order and orientation.
    BlockCholesky(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& pairs);

    void setZero();
    /// Adds `block` at (i, j) and its transpose at (j, i); at i == j adds `block`, which must be symmetric.
    void add(int i, int j, const Block& block);
    /// The stored block of rows i and columns j, or of rows j and columns i: `transposed` then. Of a diagonal block only the lower triangle is read.
    Block& block(int i, int j, bool& transposed);
    /// The diagonal block i.
    Block& diagonal(int i) { return diagonal_[position_[i]]; }

    /// Replaces the matrix by its factors. False: not positive definite to rounding.
    [[nodiscard]] bool factorise();
    /// Replaces the right-hand side b, one vector per block row, by the solution.
    void solve(std::span<Vector> b) const;

private:
    /// Where the off-diagonal block of these positions is in below_; row > column.
    [[nodiscard]] int slot(int row, int column) const;
    /// L below the diagonal.
    [[nodiscard]] const std::vector<Block>& lower() const;

    std::vector<int> position_;  // of a block row in the elimination order
    std::vector<int> order_;     // the block row at each position
    std::vector<int> first_;     // per column, into rows_ and below_
    std::vector<int> rows_;      // positions, ascending within a column
    std::vector<int> target_;    // slots that factorise() updates, in its order
    std::vector<Block> diagonal_, below_;
    std::vector<Block> scaled_;  // blockSize 3: below_ times the inverted pivot
};

extern template class BlockCholesky<3>;
extern template class BlockCholesky<Eigen::Dynamic>;

}  // namespace imomushi
