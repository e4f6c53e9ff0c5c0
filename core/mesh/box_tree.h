// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/bounds.h"

namespace imomushi {

/// A binary tree of boxes over things that move: built once, where they are at first; then its boxes follow them. Things that stay near each other, as those of
/// one body do, stay near in it.
class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(std::span<const Bounds> boxes);

    /// The same things in other places. Does not allocate.
    void follow(std::span<const Bounds> boxes);
    [[nodiscard]] bool empty() const { return nodes_.empty(); }
    /// Around all of them.
    [[nodiscard]] const Bounds& bounds() const { return nodes_.front().box; }

    /// take(i, k), i < k, for pairs of things whose boxes are no farther than `within` (m) from each other; take() may make it smaller, and ends the search by less
    /// than 0.
    template <class Take>
    void near(const double& within, const Take& take) const {
        if (!empty()) inside(0, within, take);
    }
    /// take(i, k) for a thing of this tree and one of another.
    template <class Take>
    void near(const BoxTree& other, const double& within, const Take& take) const {
        if (!empty() && !other.empty()) across(0, other, 0, within, take);
    }

    static double squaredDistance(const Bounds& a, const Bounds& b) {
        return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).squaredNorm();
    }

private:
    struct Node {
        Bounds box;
        std::int32_t right = -1;  // of an inner node; its left child is the next node. -1: leaf
        std::int32_t thing = -1;  // of a leaf
    };
    std::int32_t grow(std::span<std::int32_t> order, std::span<const Bounds> boxes);

    template <class Take>
    void inside(std::int32_t n, const double& within, const Take& take) const {
        const Node& node = nodes_[static_cast<std::size_t>(n)];
        if (node.right < 0) return;
        inside(n + 1, within, take);
        inside(node.right, within, take);
        across(n + 1, *this, node.right, within, [&take](std::int32_t i, std::int32_t k) { i < k ? take(i, k) : take(k, i); });
    }
    template <class Take>
    void across(std::int32_t a, const BoxTree& other, std::int32_t b, const double& within, const Take& take) const {
        const Node &A = nodes_[static_cast<std::size_t>(a)], &B = other.nodes_[static_cast<std::size_t>(b)];
        if (within < 0.0 || squaredDistance(A.box, B.box) > within * within) return;
        if (A.right < 0 && B.right < 0) return take(A.thing, B.thing);
        // The larger one is opened, its nearer half first.
        const bool first = B.right < 0 || (A.right >= 0 && A.box.diagonal() >= B.box.diagonal());
        const auto of = [&](std::int32_t n) {
            return squaredDistance(first ? nodes_[static_cast<std::size_t>(n)].box : A.box,
                                   first ? B.box : other.nodes_[static_cast<std::size_t>(n)].box);
        };
        std::int32_t near = (first ? a : b) + 1, far = first ? A.right : B.right;
        if (of(far) < of(near)) std::swap(near, far);
        for (const std::int32_t n : {near, far}) first ? across(n, other, b, within, take) : across(a, other, n, within, take);
    }

    std::vector<Node> nodes_;
};

}  // namespace imomushi
