// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Winding numbers around many points: what is far away of the surface counts as one area vector (Barill et al. 2018, "Fast winding numbers for soups and clouds", first order).
class WindingTree {
public:
    /// `mesh`: any triangles. The tree keeps a copy of their corners.
    explicit WindingTree(const TriangleMesh& mesh);
    /// windingNumber() to a few hundredths.
    [[nodiscard]] double at(const Vec3& point) const;

private:
    struct Node {
        Vec3 middle = Vec3::Zero(), area = Vec3::Zero();  ///< of its triangles, by their areas; the sum of their area vectors
        double far = 0.0;                                 ///< squared distance to the middle from which on it counts as one area vector
        std::int32_t begin = 0, end = 0;                  ///< its triangles
        std::int32_t right = -1;                          ///< of an inner node; its left child is the next node. -1: leaf
    };
    std::int32_t grow(std::int32_t begin, std::int32_t end);

    TriangleMesh mesh_;  ///< triangles in the order of the leaves
    std::vector<Node> nodes_;
};

}  // namespace imomushi
