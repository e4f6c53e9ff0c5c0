// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

/// Loops that the engine is measured against, written with the same care and the same library: vector instructions chosen at run time.
namespace imomushi::reference {

/// a[i] = b[i] + s * c[i], count a multiple of 64, pointers aligned to 64 bytes.
void triad(float* a, const float* b, const float* c, float s, std::size_t count);

/// Area-weighted normals from all triangles (3 body vertices each), summed at their corners and brought to unit length. sums: #vertices x 4, both
/// padded to multiples of 16 vertices; one float beyond the last position is read.
void normalsOfTriangles(const float* positions, const std::int32_t* triangles, std::size_t count, float* sums, float* normals, std::size_t vertices);

/// Brings #vertices x 3 to unit length, a multiple of 16.
void normalise(float* normals, std::size_t vertices);

}  // namespace imomushi::reference
