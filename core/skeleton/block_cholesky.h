// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

namespace imomushi {

/// Sparse symmetric positive definite systems of 3 x 3 blocks with a pattern that is known beforehand: minimum-degree order and
/// fill are found once, then assembling, factorising and solving allocate nothing.
class BlockCholesky {
public:
    /// n block rows; `pairs`: the off-diagonal blocks that may be non-zero, in any order and orientation.
    BlockCholesky(int n, const std::vector<std::pair<int, int>>& pairs);

    void setZero();
    /// Adds `block` at (i, j) and its transpose at (j, i); at i == j adds `block`, which must be symmetric.
    void add(int i, int j, const Eigen::Matrix3d& block);
    /// False: not positive definite to rounding.
    [[nodiscard]] bool factorise();
    /// Replaces b by the solution.
    void solve(std::span<Eigen::Vector3d> b) const;

private:
    [[nodiscard]] int slot(int row, int column) const;  // positions in the order of elimination, row > column
    std::vector<int> position_;                         // of a block row in the order of elimination
    std::vector<int> order_;
    std::vector<int> first_;                            // into rows_ and below_, per column
    std::vector<int> rows_;                             // ascending within a column
    std::vector<int> target_;                           // where the updates of factorise() go, in their order
    std::vector<Eigen::Matrix3d> diagonal_, below_, scaled_;
};

}  // namespace imomushi
