// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "ui/render/body_store.h"
#include "ui/render/scene.h"

namespace imomushi::render {

/// shaders/frame.glsl, std140.
struct FrameBlock {
    Eigen::Matrix4f viewProjection, view, shadow;
    Eigen::Vector4f eye, forward, keyDirection, viewport, sphere, ground, patchArea, lines, projection, right, above;
};

/// What the passes over one picture share: where camera and light see the scene from, and where there is something to see.
struct Frame {
    FrameBlock block;
    Vec3 centre = Vec3::Zero();        ///< of the bodies, m, world
    double radius = 1.0;               ///< of the sphere around them, m
    Eigen::Matrix4f heightTransform;   ///< the ground seen from below
    Eigen::AlignedBox2f content;       ///< part of the picture that bodies and markers cover, 0...1 from the lower left
    std::vector<std::size_t> frontToBack;  ///< bodies that are drawn, nearest first

    /// `drawn`: as BodyStore::update() gave it. Allocates nothing when there are no more bodies than before.
    void set(const Scene& scene, const std::vector<GpuBody*>& drawn, int width, int height);
};

}  // namespace imomushi::render
