// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace imomushi {

/// #V x 3, a point per row, contiguous as xyz xyz ...
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// #F x 3, the corners of a triangle per row, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A triangle surface. Metres, +Y up, right-handed.
struct TriangleMesh {
    Points vertices;
    Triangles triangles;
};

}  // namespace imomushi
