// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/mesh/triangle_frame.h"

namespace imomushi {

/// The displacement gradient (row: component of u, column: direction) on a triangle with corner displacements u, of a surface free of traction:
/// stretch = nu / (1 - nu). See DisplayMapping.
inline Eigen::Matrix3d gradientOf(const TriangleFrame& frame, const std::array<Vec3, 3>& u, double stretch) {
    Eigen::Matrix3d along = Eigen::Matrix3d::Zero();
    for (std::size_t c = 0; c < 3; ++c) along += u[c] * frame.slope[c].transpose();
    const Vec3 across = -(along.transpose() * frame.normal) - stretch * along.trace() * frame.normal;
    return along + across * frame.normal.transpose();
}

}  // namespace imomushi
