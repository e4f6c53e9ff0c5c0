// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/vec3.h"

namespace imomushi {

/// How a handle moves: a rigid motion, given by where the origin of its face's frame goes and how the face is turned.
struct HandlePose {
    Vec3 at = Vec3::Zero();  ///< m
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit, from rest
    /// True: in the world. False: relative to what carries it, the bones of its element or that on which it hangs; where nothing does, in the world.
    bool held = false;
    bool operator==(const HandlePose& o) const { return at == o.at && rotation.coeffs() == o.rotation.coeffs() && held == o.held; }
};

}  // namespace imomushi
