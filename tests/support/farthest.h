// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// The largest distance from a vertex of one to the nearest of the other.
inline double farthest(const Points& from, const Points& to) {
    std::vector<std::int32_t> order(static_cast<std::size_t>(to.rows()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return to(a, 1) < to(b, 1); });
    double largest = 0.0;
    for (Eigen::Index v = 0; v < from.rows(); ++v) {
        double nearest = 1e9;
        const auto middle = std::lower_bound(order.begin(), order.end(), from(v, 1), [&](std::int32_t a, double y) { return to(a, 1) < y; });
        for (auto up = middle; up != order.end() && to(*up, 1) - from(v, 1) < nearest; ++up) nearest = std::min(nearest, (to.row(*up) - from.row(v)).norm());
        for (auto down = middle; down != order.begin() && from(v, 1) - to(*std::prev(down), 1) < nearest; --down) nearest = std::min(nearest, (to.row(*std::prev(down)) - from.row(v)).norm());
        largest = std::max(largest, nearest);
    }
    return largest;
}

}  // namespace imomushi
