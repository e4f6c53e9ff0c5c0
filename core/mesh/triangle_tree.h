// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

private:
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
