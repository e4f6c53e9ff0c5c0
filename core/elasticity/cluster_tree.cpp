// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/cluster_tree.h"

#include <algorithm>

namespace imomushi {

namespace {

Box merged(const Box& a, const Box& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

}  // namespace

int bisections(std::int32_t nodes, std::int32_t size) {
    int depth = 0;
    while ((static_cast<std::int64_t>(nodes) + (std::int64_t{1} << depth) - 1) >> depth > size) ++depth;
    return depth;
}

ClusterTree::ClusterTree(const BlockSource& source, std::int32_t leafSize) {
    const std::int32_t nodes = source.nodes();
    order_.resize(static_cast<std::size_t>(nodes));
    std::vector<Vec3> position(order_.size());
    for (std::int32_t i = 0; i < nodes; ++i) {
        order_[static_cast<std::size_t>(i)] = i;
        position[static_cast<std::size_t>(i)] = source.position(i);
    }
    if (nodes == 0) return;
    const int depth = bisections(nodes, leafSize);
    clusters_.resize((std::size_t{2} << depth) - 1);
    clusters_[0].begin = 0;
    clusters_[0].end = nodes;
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
        Cluster& c = clusters_[i];
        const auto begin = order_.begin() + c.begin, end = order_.begin() + c.end;
        c.points.low = c.points.high = position[static_cast<std::size_t>(*begin)];
        for (auto it = begin; it != end; ++it) {
            const Vec3& p = position[static_cast<std::size_t>(*it)];
            c.points = merged(c.points, {p, p});
        }
        if (c.depth == depth) {
            c.support = source.support(*begin);
            for (auto it = begin; it != end; ++it) c.support = merged(c.support, source.support(*it));
            continue;
        }
        int axis = 0;
        (c.points.high - c.points.low).maxCoeff(&axis);
        const auto middle = begin + (c.size() + 1) / 2;
        std::nth_element(begin, middle, end, [&](std::int32_t a, std::int32_t b) {
            const double pa = position[static_cast<std::size_t>(a)][axis], pb = position[static_cast<std::size_t>(b)][axis];
            return pa != pb ? pa < pb : a < b;
        });
        c.first = static_cast<std::int32_t>(2 * i + 1);
        c.second = static_cast<std::int32_t>(2 * i + 2);
        const auto split = static_cast<std::int32_t>(middle - order_.begin());
        Cluster &first = clusters_[static_cast<std::size_t>(c.first)], &second = clusters_[static_cast<std::size_t>(c.second)];
        first.begin = c.begin;
        first.end = second.begin = split;
        second.end = c.end;
        first.depth = second.depth = c.depth + 1;
    }
    for (std::size_t i = clusters_.size(); i-- > 0;)
        if (!clusters_[i].leaf())
            clusters_[i].support = merged(clusters_[static_cast<std::size_t>(clusters_[i].first)].support,
                                          clusters_[static_cast<std::size_t>(clusters_[i].second)].support);
}

}  // namespace imomushi
