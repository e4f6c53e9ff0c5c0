// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// An axis-parallel box.
struct Box {
    Vec3 low, high;
};

/// A large square matrix that is known by its entries only: three rows and three columns per node. Rows belong to a point (a collocation point),
/// columns to a piece of surface around it. All functions are called from several threads at once and must not throw but std::bad_alloc.
class BlockSource {
public:
    /// Some columns, prepared for evaluating many rows of them.
    class Columns {
    public:
        virtual ~Columns() = default;
        /// Fills `out`, 3 #rowNodes x 3 #columns by columns without gaps.
        virtual void rows(std::span<const std::int32_t> rowNodes, double* out) const = 0;
    };

    virtual ~BlockSource() = default;
    [[nodiscard]] virtual std::int32_t nodes() const = 0;
    /// Where the rows of a node are taken.
    [[nodiscard]] virtual Vec3 position(std::int32_t node) const = 0;
    /// What the columns of a node integrate over; entries are smooth in the position of a row outside of this box.
    [[nodiscard]] virtual Box support(std::int32_t node) const = 0;
    [[nodiscard]] virtual std::unique_ptr<Columns> columns(std::span<const std::int32_t> columnNodes) const = 0;
};

/// Nodes sorted so that near ones are neighbours, halved again and again along the longest side of their box.
class ClusterTree {
public:
    struct Cluster {
        std::int32_t begin, end;            ///< a range of order()
        std::int32_t first = -1, second = -1;  ///< its halves, or -1
        int depth = 0;
        Box points, support;
        [[nodiscard]] std::int32_t size() const { return end - begin; }
        [[nodiscard]] bool leaf() const { return first < 0; }
    };
    ClusterTree() = default;
    ClusterTree(const BlockSource& source, std::int32_t leafSize);
    [[nodiscard]] const std::vector<Cluster>& clusters() const { return clusters_; }  ///< the whole comes first
    [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }   ///< the node at each place

private:
    std::vector<Cluster> clusters_;
    std::vector<std::int32_t> order_;
};

/// A matrix in blocks: those between clusters that are far from each other, compared with their size, as products U V^T of low rank, found by
/// adaptive cross approximation (Bebendorf 2000) in blocks of three, checked on sampled rows and recompressed; the others dense. Single precision.
/// Rows and columns of a vector follow the tree: unknown 3 i + k is axis k of node tree().order()[i].
/// The same source gives the same bytes for any number of threads.
class HierarchicalMatrix {
public:
    struct Options {
        /// The error of a row, relative to the size of a usual row of the matrix (2-norms), that blocks of low rank may make together; 1e-1...1e-7.
        double tolerance = 1e-5;
        int threads = 1;
        std::size_t memoryLimit = ~std::size_t{0};  ///< bytes of the stored blocks
    };
    /// Clusters of at most this many nodes are one dense block on the diagonal of the coarsest splitting, see depthOf().
    static constexpr std::int32_t kDiagonalSize = 256;

    /// Errors: "cancelled", "no-memory", "bad-value" (an entry is not finite).
    static Result<HierarchicalMatrix> build(const BlockSource& source, const Options& options, const Progress& progress);

    /// What build() will need, extrapolated from some blocks of each size that are built now.
    struct Estimate {
        double seconds = 0.0;
        std::size_t bytes = 0;
        std::size_t ranks = 0;         ///< sum of the ranks of all blocks
        double secondsPerEntry = 0.0;  ///< of one thread that evaluates a dense block
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
    [[nodiscard]] double rowScale() const { return rowScale_; }  ///< the 2-norm of a usual row
    /// Blocks between the two halves of a cluster of depth d (off-diagonal there) are level d; those inside the smallest clusters kept whole
    /// (kDiagonalSize) are the last level.
    [[nodiscard]] int levels() const { return static_cast<int>(levelBegin_.size()) - 1; }
    [[nodiscard]] std::span<const Block> level(int l) const {
        return std::span(blocks_).subspan(levelBegin_[static_cast<std::size_t>(l)],
                                          levelBegin_[static_cast<std::size_t>(l) + 1] - levelBegin_[static_cast<std::size_t>(l)]);
    }
    [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }

    /// y := B x or B^T x for the sum B of some blocks; x and y are size() x columns by columns without gaps. False: cancelled.
    bool multiply(std::span<const Block> blocks, const float* x, double* y, std::int32_t columns, bool transposed, int threads,
                  const Progress& progress) const;
    /// The same, rounded: blocks are summed in double precision.
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
