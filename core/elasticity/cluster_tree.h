// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/elasticity/block_source.h"

namespace imomushi {

/// The cluster tree of a hierarchical matrix (Hackbusch, Hierarchical Matrices, 2015, section 5.4): nodes are bisected at the median along the longest
/// side of their bounding box until at most `leafSize` are left. All leaves have the same depth.
class ClusterTree {
public:
    struct Cluster {
        std::int32_t begin, end;               ///< a range of order()
        std::int32_t first = -1, second = -1;  ///< children; -1: a leaf
        int depth = 0;                         ///< 0: the root
        Box points, support;                   ///< of the collocation points, and of BlockSource::support()
        [[nodiscard]] std::int32_t size() const { return end - begin; }
        [[nodiscard]] bool leaf() const { return first < 0; }
    };
    ClusterTree() = default;
    ClusterTree(const BlockSource& source, std::int32_t leafSize);
    [[nodiscard]] const std::vector<Cluster>& clusters() const { return clusters_; }  ///< breadth first: the children of i are 2 i + 1 and 2 i + 2
    [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }   ///< node at each place of the tree

private:
    std::vector<Cluster> clusters_;
    std::vector<std::int32_t> order_;
};

/// How often `nodes` nodes must be bisected until no cluster has more than `size`.
int bisections(std::int32_t nodes, std::int32_t size);

}  // namespace imomushi
