// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace imomushi::render {

/// Where the scene is seen from. Right-handed, looks from eye to target.
struct Camera {
    Vec3 eye = Vec3(0, 1, 4), target = Vec3::Zero(), up = Vec3::UnitY();  ///< m, world
    double fov = 0.6;            ///< vertical angle in radians (perspective)
    bool orthographic = false;
    double orthoHeight = 4.0;    ///< m, visible height (orthographic)
    /// World -> view space: x right, y up, z towards the eye.
    [[nodiscard]] Eigen::Matrix4d view() const;
    /// View -> clip space. Near and far planes are chosen around the sphere (centre, radius) that holds the scene.
    [[nodiscard]] Eigen::Matrix4d projection(double aspect, const Vec3& sceneCentre, double sceneRadius) const;
};

}  // namespace imomushi::render
