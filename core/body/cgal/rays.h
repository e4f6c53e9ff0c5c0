// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Rays against the triangles of a mesh.
class RayTree {
public:
    /// `which`: triangles of `mesh`; those without area are left out. Keeps copies of their corners.
    RayTree(const TriangleMesh& mesh, const std::vector<std::int32_t>& which);
    explicit RayTree(const TriangleMesh& mesh);
    ~RayTree();
    RayTree(const RayTree&) = delete;
    RayTree& operator=(const RayTree&) = delete;

    struct Hit {
        std::int32_t triangle = -1;  ///< -1: none
        double distance = std::numeric_limits<double>::infinity();
    };
    /// The first triangle on the segment from `from` along the unit vector `direction`, at most `reach` away, but for triangle `except`.
    [[nodiscard]] Hit first(const Vec3& from, const Vec3& direction, double reach, std::int32_t except) const;
    /// Whether a point lies inside of a closed surface, by the parity of its crossings with two of three rays.
    [[nodiscard]] bool inside(const Vec3& point) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace imomushi
