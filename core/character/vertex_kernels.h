// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/character/response_format.h"

namespace imomushi {

/// The loops over vertices of a frame, in single precision, with vector instructions chosen at run time. A block is kVertexBlock body vertices
/// that follow each other in the body's order, kept as x of all, y of all, z of all.
inline constexpr int kVertexBlock = 16;
/// Int16 sums this many columns in integers before it adds them up in single precision. Even.
inline constexpr int kColumnGroup = 16;

/// Vertices that are evaluated together. Pointers are aligned to 64 bytes.
struct VertexBlocks {
    ResponseFormat format = ResponseFormat::Float;
    /// A': float, or half as bits, per block, per column, 3 * kVertexBlock. Int16: per block, per pair of columns, 3 * kVertexBlock pairs; a
    /// last column without a partner is paired with zeros.
    const void* response = nullptr;
    const float* rest = nullptr;           ///< per block 3 * kVertexBlock, m, about the element's middle
    const std::int32_t* first = nullptr;   ///< per block: its first body vertex
    int columns = 0;
};

/// x -> linear (row by row) times x plus shift.
struct AffineFloat {
    float linear[9];
    float shift[3];
};

/// What the vertices of an element are made of in a frame; see ResponseBlocks::weigh().
struct Weights {
    AffineFloat affine;                    ///< what is done to rest positions before A' v is added
    const float* columns = nullptr;        ///< Float and Half: per column
    const std::int16_t* pairs = nullptr;   ///< Int16: per column, and a zero after an odd number of them
    const float* groups = nullptr;         ///< Int16: metres per unit of the sum, for each kColumnGroup columns
};

/// Blocks [begin, end): affine(rest) + A' v, placed. Writes kVertexBlock vertices from the first one of each block on, so `positions` (#body vertices
/// x 3) is padded by as many. local (like rest; may be null): the same before it is placed, for place().
void evaluateAndPlace(const VertexBlocks& blocks, const Weights& weights, const AffineFloat& placement, std::size_t begin, std::size_t end,
                      float* local, float* positions);

/// The same without the product, from `local`.
void place(const float* local, const std::int32_t* first, const AffineFloat& placement, std::size_t begin, std::size_t end, float* positions);

/// Where the normal of vertex v comes from: with e = p[v] - p[c], the direction of (p[a] - p[b] + part[0] e) x (p[d] - p[c] + part[1] e).
struct NormalStencil {
    std::int32_t a = 0, b = 0, c = 0, d = 0;
    float part[2] = {0.0f, 0.0f};
};

/// Unit normals (x 3) of vertices [begin, end) from positions (x 3); +z where the stencil has no area. begin is a multiple of kVertexBlock;
/// stencils, normals and positions are padded to one, and positions by one float more. scale: makes the body about 1 large.
void findNormals(const float* positions, const NormalStencil* stencils, float scale, std::size_t begin, std::size_t end, float* normals);

}  // namespace imomushi
