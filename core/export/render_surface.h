// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/export/motion.h"

namespace imomushi {

/// The render mesh of an element: attributes and materials of the imported file, without the triangles inside joints.
struct RenderSurface {
    std::vector<std::int32_t> body;  ///< per vertex: its body vertex
    Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> normals;    ///< unit, at rest, smooth across joints
    Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor> texCoords;  ///< no rows: none
    Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> colors;     ///< no rows: none
    struct Part {
        int material = -1;                     ///< of the render mesh, -1: none
        std::vector<std::uint32_t> triangles;  ///< three vertices each
    };
    std::vector<Part> parts;  ///< none is empty
};

/// `normals`: of body vertices in the positions that are written (Character::surface()), x 3.
RenderSurface renderSurface(const CharacterInput& input, int element, const float* normals);

}  // namespace imomushi
