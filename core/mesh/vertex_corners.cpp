// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/vertex_corners.h"

#include <numeric>

namespace imomushi {

VertexCorners::VertexCorners(std::span<const std::int32_t> corners, std::size_t vertices, std::span<const char> which) : first_(vertices + 1, 0) {
    const auto each = [&](const auto& visit) {
        for (std::size_t i = 0; i < corners.size(); ++i)
            if (which.empty() || which[i / 3]) visit(static_cast<std::size_t>(corners[i]), i);
    };
    each([&](std::size_t v, std::size_t) { ++first_[v + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    corners_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    each([&](std::size_t v, std::size_t i) { corners_[next[v]++] = static_cast<std::int32_t>(i); });
}

}  // namespace imomushi
