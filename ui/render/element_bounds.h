// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/character/surface_recipe.h"

namespace imomushi::render {

/// Boxes around an element whose vertices only the GPU knows, world, m.
struct BoundingBoxes {
    Eigen::AlignedBox3f conservative;  ///< holds every vertex, up to some percent larger
    Eigen::AlignedBox3f tight;         ///< the size of the element within some tenths of a percent; vertices may lie outside
};

/// Computes them from joint parameters: free vertices that are near each other at rest are taken together in clusters.
class ElementBounds {
public:
    void prepare(const SurfaceRecipe::Element& element);
    /// In the element's present frame. Allocates nothing.
    [[nodiscard]] BoundingBoxes at(const SurfaceRecipe::Element& element) const;

private:
    /// Vertices that are near each other at rest.
    struct Cluster {
        Eigen::AlignedBox3f rest;
        Eigen::Vector3f mean;
        Eigen::Matrix3Xf middleOf, halfOf, meanOf;  ///< per mode: of A' over the cluster
    };
    std::vector<Cluster> clusters_;
    std::vector<int> sampledHeld_;  ///< into Element::held: some of each face
};

}  // namespace imomushi::render
