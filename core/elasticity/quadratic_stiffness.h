// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/elasticity/tetrahedral_mesh.h"

namespace imomushi {

/// xyz of each node, a column per right-hand side.
using NodeValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The nodes of displacement quadratic on tetrahedra: their corners, then the middles of their edges.
class QuadraticNodes {
public:
    explicit QuadraticNodes(const TetrahedralMesh& mesh);
    [[nodiscard]] std::int32_t count() const { return corners_ + static_cast<std::int32_t>(keys_.size()); }
    /// The middle of the edge between two corners, -1: there is no such edge.
    [[nodiscard]] std::int32_t at(std::int32_t a, std::int32_t b) const;
    /// #T x 10, of each tetrahedron: corners, then the middles of the edges 01 02 03 12 13 23.
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 10, Eigen::RowMajor> nodes;

private:
    std::int32_t corners_;
    std::vector<std::uint64_t> keys_;  ///< of edges, by their ends, ascending
};

/// The stiffness of tetrahedra with quadratic displacement for shear modulus 1: symmetric, in columns of 3 x 3 blocks, of which those on and below the diagonal are kept.
struct QuadraticStiffness {
    using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    std::vector<std::size_t> start;     ///< of each column, and the end of the last
    std::vector<std::int32_t> row;      ///< of each block, ascending in a column
    std::vector<Block> block;
    std::vector<std::size_t> freeRows;  ///< of each free column: its rows that are free, which come first

    /// `place`: row and column of each node; the first `freeNodes` of them are free. False: cancelled.
    bool build(const TetrahedralMesh& mesh, const QuadraticNodes& nodes, const std::vector<std::int32_t>& place, std::int32_t freeNodes, double nu, int threads, const Progress& progress);
    /// The product with `x`, 3 rows per node by its place. `heldOnly`: only with the values of nodes that are not free.
    [[nodiscard]] NodeValues times(const NodeValues& x, bool heldOnly, int threads) const;
    [[nodiscard]] std::size_t bytes() const { return block.size() * (sizeof(Block) + sizeof(std::int32_t)); }
};

}  // namespace imomushi
