// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace imomushi {

/// The loops over vertices and triangles of a frame, in single precision, with vector instructions chosen at run time.
/// Free vertices come in blocks of kVertexBlock: x of all, y of all, z of all; the last block is padded with zeros.
inline constexpr int kVertexBlock = 8;

/// The free vertices of one element. Pointers to blocks are aligned to 64 bytes.
struct FreeBlocks {
    const float* response = nullptr;  ///< A': per block, per column, 3 * kVertexBlock
    const float* rest = nullptr;      ///< per block 3 * kVertexBlock, m, about the element's middle
    float* local = nullptr;           ///< like rest: displaced, in the frame of the element
    const std::int32_t* vertex = nullptr;  ///< per block kVertexBlock body vertices, -1: padding
    std::size_t blocks = 0;
    int columns = 0;
};

/// World = rotation (row by row) times local plus shift.
struct Placement {
    float rotation[9];
    float shift[3];
};

/// local = rest + A' v, then placed. positions: #body vertices x 3.
void evaluateAndPlace(const FreeBlocks& blocks, const float* v, const Placement& placement, float* positions);

/// The same without the product: local is as it was.
void place(const FreeBlocks& blocks, const Placement& placement, float* positions);

/// Twice the area-weighted normals of the triangles (3 body vertices each) around every vertex, times scale squared. positions: one float beyond
/// the last vertex is read and ignored. sums: #vertices x 4, the fourth lane is arbitrary.
void sumNormals(const float* positions, const std::int32_t* triangles, std::size_t count, float scale, float* sums, std::size_t vertices);

/// normals (#vertices x 3) = sums of unit length; +z where a sum vanishes. Both are padded to a multiple of 16 vertices.
void normalise(const float* sums, float* normals, std::size_t vertices);

}  // namespace imomushi
