// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// Linear blend skinning as fast as we know, with vector instructions chosen at run time: what our own frame is measured against.
namespace imomushi {

/// Linear blend skinning with four weights. Matrices are 4 columns of 4 floats (the last row is 0 0 0 1).
struct LinearSkin {
    const float* matrices = nullptr;       ///< #bones x 16, aligned to 64 bytes
    const float* rest = nullptr;           ///< #vertices x 4: x y z 1
    const float* weights = nullptr;        ///< #vertices x 4, sum 1
    const std::uint16_t* offsets = nullptr;  ///< #vertices x 4: 16 * bone
};
/// The matrix of a vertex is blended in registers, then applied; one vertex at a time. positions: #vertices x 3 and one float more.
void skinByMatrix(const LinearSkin& skin, std::size_t begin, std::size_t end, float* positions);

/// The same skin as arrays of components in blocks of 16 vertices.
struct LinearSkinBlocks {
    const float* matrices = nullptr;       ///< #bones x 16
    const float* rest = nullptr;           ///< per block x, y, z
    const float* weights = nullptr;        ///< per block first, second, third, fourth
    const std::int32_t* offsets = nullptr; ///< like weights: 16 * bone
};
/// Many vertices at a time, entries of matrices gathered.
void skinByGather(const LinearSkinBlocks& skin, std::size_t blocks, float* positions);

}  // namespace imomushi
