// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/elasticity/dense_lu.h"
#include "core/elasticity/hierarchical_matrix.h"

namespace imomushi {

/// An approximate inverse of a hierarchical matrix: hierarchically off-diagonal low-rank factorisation (HODLR: Ambikasaran and Darve, J. Sci. Comput. 57
/// (2013) 477). The diagonal blocks of the deepest clusters are dense; the two blocks between the children of every cluster above are U V^T. With D the
/// block diagonal of the children, D + U V^T = D (I + X V^T), X = D^-1 U, whose inverse needs only the small capacitance matrix I + V^T X (Woodbury).
/// Ranks are truncated coarsely, so that it serves as a preconditioner. No pivoting across blocks: it suits matrices with a dominant diagonal, as those of
/// boundary equations are. Single precision; the same bytes for any number of threads.
class HodlrFactorisation {
public:
    /// `matrix` must stay where it is as long as this. False: cancelled.
    bool build(const HierarchicalMatrix& matrix, int threads, const Progress& progress);
    /// x := A^-1 x, x of n x columns in the order of the tree. False: cancelled.
    bool solve(float* x, std::int32_t columns, int threads, const Progress& progress) const { return solveFrom(0, x, columns, threads, progress); }
    [[nodiscard]] bool singular() const { return singular_; }
    [[nodiscard]] std::size_t bytes() const;

    /// Upper bound of bytes() before it is built.
    static std::size_t estimateBytes(std::int32_t nodes);
    /// Bytes that build() holds beside the matrix and the factors; ranks: HierarchicalMatrix::ranks().
    static std::size_t estimateWorkBytes(std::int32_t nodes, std::size_t ranks);
    /// Floating-point operations of build() for a hierarchical matrix of so many stored entries.
    static double estimateFlops(std::int32_t nodes, double entries);

private:
    struct Lu {
        std::vector<float> a;
        std::vector<std::int32_t> pivots;
    };
    /// Rows [begin, end) of unknowns that belong to one cluster.
    struct RowRange {
        std::int32_t cluster, begin, end;
    };
    struct Level {
        std::int32_t rank = 0;
        LargeArray<float> x, v;       ///< n x rank
        std::vector<Lu> capacitance;  ///< per cluster, 2 rank x 2 rank
        std::vector<RowRange> ranges; ///< of the children
    };
    bool factoriseDiagonal(const HierarchicalMatrix& matrix, int threads, const Progress& progress);
    bool compress(const HierarchicalMatrix& matrix, int depth, int threads, const Progress& progress);
    [[nodiscard]] LargeArray<float> columnsOf(std::int32_t count) const {
        return LargeArray<float>(static_cast<std::size_t>(n_) * static_cast<std::size_t>(count));
    }
    /// x := D^-1 x for the block diagonal D of the clusters of depth `top`.
    bool solveFrom(int top, float* x, std::int32_t columns, int threads, const Progress& progress) const;
    static bool factorise(Lu& lu, std::int32_t size);
    static std::vector<RowRange> rangesOf(const std::vector<ClusterTree::Cluster>& clusters, int depth);
    static bool innerProducts(const std::vector<RowRange>& ranges, std::int32_t firstCluster, std::int32_t clusters, std::int32_t n, const float* a,
                              std::int32_t rank, const float* b, std::int32_t columns, std::vector<float>& out, int threads, const Progress& progress);

    std::int32_t n_ = 0;
    const std::vector<ClusterTree::Cluster>* clusters_ = nullptr;
    std::vector<Lu> diagonal_;
    std::vector<Level> levels_;
    bool singular_ = false;
};

}  // namespace imomushi
