// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/box_tree.h"

#include <algorithm>
#include <numeric>

namespace imomushi {
namespace {

Bounds around(const Bounds& a, const Bounds& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

}  // namespace

BoxTree::BoxTree(std::span<const Bounds> boxes) {
    if (boxes.empty()) return;
    nodes_.reserve(2 * boxes.size());
    std::vector<std::int32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    grow(order, boxes);
    follow(boxes);
}

std::int32_t BoxTree::grow(std::span<std::int32_t> order, std::span<const Bounds> boxes) {
    const auto at = static_cast<std::int32_t>(nodes_.size());
    nodes_.emplace_back();
    if (order.size() == 1) {
        nodes_.back().thing = order[0];
        return at;
    }
    const auto middle = [&](std::int32_t i) -> Vec3 {
        return boxes[static_cast<std::size_t>(i)].low + boxes[static_cast<std::size_t>(i)].high;
    };
    Vec3 low = middle(order[0]), high = low;
    for (const std::int32_t i : order) {
        low = low.cwiseMin(middle(i));
        high = high.cwiseMax(middle(i));
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t half = order.size() / 2;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(), [&](std::int32_t x, std::int32_t y) {
        const double p = middle(x)[axis], q = middle(y)[axis];
        return p < q || (p == q && x < y);
    });
    grow(order.first(half), boxes);
    const std::int32_t right = grow(order.subspan(half), boxes);
    nodes_[static_cast<std::size_t>(at)].right = right;
    return at;
}

void BoxTree::follow(std::span<const Bounds> boxes) {
    // Children stand behind their parents.
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        Node& node = nodes_[n];
        node.box = node.right < 0 ? boxes[static_cast<std::size_t>(node.thing)]
                                  : around(nodes_[n + 1].box, nodes_[static_cast<std::size_t>(node.right)].box);
    }
}

}  // namespace imomushi
