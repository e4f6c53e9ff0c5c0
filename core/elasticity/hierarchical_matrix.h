// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/cluster_tree.h"

namespace imomushi {

/// A hierarchical matrix (H-matrix: Hackbusch, Computing 62 (1999) 89): blocks between clusters that are far apart for their size are stored as
/// products U V^T of low rank, found by adaptive cross approximation and recompressed (see cross_approximation.h); all others are dense. Entries are in
/// single precision. Vectors follow the cluster tree: component 3 i + k is axis k of node tree().order()[i].
/// The same source gives the same bytes for any number of threads.
class HierarchicalMatrix {
public:
    struct Options {
        /// Error that the low-rank blocks of a row may make together, relative to rowScale() (2-norms); 1e-1...1e-7.
        double tolerance = 1e-5;
        int threads = 1;
        std::size_t memoryLimit = ~std::size_t{0};  ///< bytes of the stored blocks
    };
    /// Most nodes of the clusters whose diagonal blocks are the last level of level().
    static constexpr std::int32_t kDiagonalSize = 256;

    /// Errors: "cancelled", "no-memory", "bad-value" (an entry is not finite).
    static Result<HierarchicalMatrix> build(const BlockSource& source, const Options& options, const Progress& progress);

    /// What build() will need, extrapolated from some blocks of each size that are built as samples.
    struct Estimate {
        double seconds = 0.0;
        std::size_t bytes = 0;
        std::size_t ranks = 0;         ///< sum of the ranks of all blocks
        double secondsPerEntry = 0.0;  ///< of one thread, to compute the entries of a dense block
    };
    static Result<Estimate> estimate(const BlockSource& source, const Options& options, const Progress& progress);

    struct Block {
        std::int32_t rowBegin, rowEnd, columnBegin, columnEnd;  ///< places in the tree
        std::int32_t rank = -1;          ///< -1: dense
        std::unique_ptr<float[]> u;      ///< 3 rows x rank, or the dense block, by columns
        std::unique_ptr<float[]> v;      ///< 3 columns x rank, by columns
    };

    [[nodiscard]] const ClusterTree& tree() const { return tree_; }
    [[nodiscard]] std::int32_t size() const { return 3 * static_cast<std::int32_t>(tree_.order().size()); }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    [[nodiscard]] std::size_t ranks() const { return ranks_; }
    [[nodiscard]] double rowScale() const { return rowScale_; }  ///< 2-norm of a typical row
    /// The blocks of level d lie between the two children of clusters of depth d; those of the last level are diagonal: they lie inside clusters of at
    /// most kDiagonalSize nodes.
    [[nodiscard]] int levels() const { return static_cast<int>(levelBegin_.size()) - 1; }
    [[nodiscard]] std::span<const Block> level(int l) const {
        return std::span(blocks_).subspan(levelBegin_[static_cast<std::size_t>(l)],
                                          levelBegin_[static_cast<std::size_t>(l) + 1] - levelBegin_[static_cast<std::size_t>(l)]);
    }
    [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }

    /// y := B x or B^T x for the sum B of some blocks; x and y are size() x columns by columns without gaps. False: cancelled.
    bool multiply(std::span<const Block> blocks, const float* x, double* y, std::int32_t columns, bool transposed, int threads,
                  const Progress& progress) const;
    /// The same, rounded to single precision once the blocks are summed in double precision.
    bool multiply(std::span<const Block> blocks, const float* x, float* y, std::int32_t columns, bool transposed, int threads,
                  const Progress& progress) const;

private:
    template <class Real>
    bool product(std::span<const Block> blocks, const float* x, Real* y, std::int32_t columns, bool transposed, int threads,
                 const Progress& progress) const;

    ClusterTree tree_;
    std::vector<Block> blocks_;
    std::vector<std::size_t> levelBegin_;
    std::size_t bytes_ = 0, ranks_ = 0;
    double rowScale_ = 0.0;
};

}  // namespace imomushi
