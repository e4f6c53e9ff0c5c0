// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/character/deform_input.h"

namespace imomushi::render {

/// Boxes around an element whose vertices only the GPU knows, world, m.
struct BoundingBoxes {
    Eigen::AlignedBox3f conservative;  ///< holds every vertex, up to some percent larger
    Eigen::AlignedBox3f tight;         ///< the size of the element within some tenths of a percent; vertices may lie outside
};

/// Computes them from joint parameters: free vertices that are near each other at rest are taken together in clusters.
class ElementBounds {
public:
    void prepare(const DeformInput::Element& element);
    /// In the element's present frame. Allocates nothing.
    [[nodiscard]] BoundingBoxes at(const DeformInput::Element& element) const;

private:
    /// Vertices that are near each other at rest.
    struct Cluster {
        Eigen::AlignedBox3f rest;
        Eigen::Vector3f mean;
        Eigen::Matrix3Xf middleOf, halfOf, meanOf;  ///< per mode: of A' over the cluster
    };
    std::vector<Cluster> clusters_;
    std::vector<int> sampledHeld_;  ///< into Element::held: some of each place
    std::vector<float> offsets_;    ///< per face: the longest of its joint parts, m
};

}  // namespace imomushi::render
