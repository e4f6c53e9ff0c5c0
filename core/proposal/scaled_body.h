// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "core/body/cut.h"
#include "core/mesh/mesh.h"

// Of proposeFromShape() alone.
namespace imomushi {

/// The largest closed surface of a body along its own axes, in coordinates with a bounding box of diagonal 1 about the origin, rounded to a grid of 2^-24: so a body that was turned, mirrored or scaled
/// is the same one here, bit for bit but for rare chances.
struct ScaledBody {
    TriangleMesh mesh;
    Vec3 centre = Vec3::Zero();
    double diagonal = 1.0;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: where its coordinates point in the world; may mirror
    [[nodiscard]] Vec3 back(const Vec3& p) const { return centre + diagonal * (axes * p); }
    [[nodiscard]] CutPlane back(const CutPlane& plane) const { return {back(plane.origin), axes * plane.normal}; }
    [[nodiscard]] double height(const Vec3& p) const { return axes.row(1).dot(p); }  ///< in diagonals
    [[nodiscard]] Vec3 direction(const Vec3& world) const { return axes.transpose() * world; }
};

/// `body`: m, closed, outward; vertices and triangles as in TriangleMesh.
ScaledBody scaledBody(const TriangleMesh& body);

}  // namespace imomushi
