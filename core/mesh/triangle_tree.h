// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Nearest points on a set of triangles: a binary tree of boxes. Segments are triangles whose last two corners are the same.
class TriangleTree {
public:
    /// `which`: the triangles of `mesh` to search, at least one. The tree keeps a copy of their corners.
    TriangleTree(const TriangleMesh& mesh, std::vector<std::int32_t> which);
    /// All of them.
    explicit TriangleTree(const TriangleMesh& mesh);

    struct Hit {
        std::int32_t triangle = -1;  ///< -1: none
        double squaredDistance = std::numeric_limits<double>::infinity();
        Vec3 barycentric = Vec3::Zero();  ///< of the nearest point in the triangle, >= 0, sum 1
    };
    /// The nearest point of all triangles; of equally near ones the lowest.
    [[nodiscard]] Hit nearest(const Vec3& point) const { return search<false>(point, Vec3::Zero()); }
    /// The same among triangles whose normals are less than 90 degrees from `direction`.
    [[nodiscard]] Hit nearestFacing(const Vec3& point, const Vec3& direction) const { return search<true>(point, direction); }
    /// All triangles with a point at most `distance` away, ascending, and perhaps some that are a little farther.
    [[nodiscard]] std::vector<std::int32_t> within(const Vec3& point, double distance) const;
    /// True where `found(triangle)` is true of a triangle. Only those are asked about that lie in boxes of which `reaches(low, high)` is true.
    template <class Reaches, class Found>
    [[nodiscard]] bool any(const Reaches& reaches, const Found& found) const {
        std::array<std::int32_t, kDeepest> open{};
        for (std::size_t count = 1; count > 0;) {
            const std::int32_t n = open[--count];
            const Node& node = nodes_[static_cast<std::size_t>(n)];
            if (!reaches(node.low, node.high)) continue;
            if (node.right >= 0) {
                open[count++] = node.right;
                open[count++] = n + 1;
            } else if (std::any_of(order_.begin() + node.begin, order_.begin() + node.end, found)) {
                return true;
            }
        }
        return false;
    }

private:
    static constexpr std::size_t kDeepest = 64;  ///< halving 2^31 triangles cannot go deeper
    struct Node {
        Vec3 low, high;
        std::int32_t begin = 0, end = 0;  ///< into order_, of a leaf
        std::int32_t right = -1;          ///< of an inner node; its left child is the next node. -1: leaf
    };
    struct Corners {
        Vec3 a, b, c;
    };
    std::int32_t grow(std::int32_t begin, std::int32_t end);
    template <bool kFacing>
    Hit search(const Vec3& point, const Vec3& direction) const;

    std::vector<std::int32_t> order_;  ///< triangles in the order of the leaves
    std::vector<Corners> corners_;     ///< of order_
    std::vector<Node> nodes_;
};

}  // namespace imomushi
