// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// Loops that the engine is measured against, written with the same care and the same library: vector instructions chosen at run time.
namespace imomushi::reference {

/// a[i] = b[i] + s * c[i], count a multiple of 64, pointers aligned to 64 bytes.
void triad(float* a, const float* b, const float* c, float s, std::size_t count);

/// Linear blend skinning with four weights. Matrices are 4 columns of 4 floats (the last row is 0 0 0 1).
struct Skin {
    const float* matrices = nullptr;       ///< #bones x 16, aligned to 64 bytes
    const float* rest = nullptr;           ///< #vertices x 4: x y z 1
    const float* weights = nullptr;        ///< #vertices x 4, sum 1
    const std::uint16_t* offsets = nullptr;  ///< #vertices x 4: 16 * bone
};
/// The matrix of a vertex is blended in registers, then applied; one vertex at a time. positions: #vertices x 3 and one float more.
void skinByMatrix(const Skin& skin, std::size_t begin, std::size_t end, float* positions);

/// The same skin as arrays of components in blocks of 16 vertices.
struct SkinBlocks {
    const float* matrices = nullptr;       ///< #bones x 16
    const float* rest = nullptr;           ///< per block x, y, z
    const float* weights = nullptr;        ///< per block first, second, third, fourth
    const std::int32_t* offsets = nullptr; ///< like weights: 16 * bone
};
/// Many vertices at a time, entries of matrices gathered.
void skinByGather(const SkinBlocks& skin, std::size_t blocks, float* positions);

/// Area-weighted normals from all triangles (3 body vertices each), summed at their corners and brought to unit length. sums: #vertices x 4, both
/// padded to multiples of 16 vertices; one float beyond the last position is read.
void normalsOfTriangles(const float* positions, const std::int32_t* triangles, std::size_t count, float* sums, float* normals, std::size_t vertices);

/// Brings #vertices x 3 to unit length, a multiple of 16.
void normalise(float* normals, std::size_t vertices);

}  // namespace imomushi::reference
