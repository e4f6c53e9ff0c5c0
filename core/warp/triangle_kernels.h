// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace imomushi {

/// What the bend warp does to every triangle of a frame (bend_warp.h, steps 3 to 5), by the vector instructions of the machine. Vectors of vertices are
/// x y z and nothing, vertex after vertex; lengths are in sizes of the element. Nothing here allocates, locks or fails; finite numbers stay finite.
inline constexpr int kWarpBatch = 16;

/// Triangles side by side. Lanes after the last triangle repeat it, with no energy.
struct WarpBatch {
    std::int32_t corner[3][kWarpBatch];  ///< 4 * vertex
    /// Energy of two sides d1, d2 from corner 0: 1/2 (c11 d1.d1 + 2 c12 d1.d2 + c22 d2.d2), the integral of |gradient|^2 / 2.
    float c11[kWarpBatch], c12[kWarpBatch], c22[kWarpBatch];
};

/// Triangles side by side, all of a surface. Lanes after the last have one vertex at all corners.
struct SurfaceBatch {
    std::int32_t corner[3][kWarpBatch];  ///< 4 * vertex
};

/// The target shapes of triangles: their two sides at rest after strains, in their planes, and the axes of the planes after rotations.
struct TargetBatch {
    float p1x[kWarpBatch], p1y[kWarpBatch], p2x[kWarpBatch], p2y[kWarpBatch];
    float x[3][kWarpBatch], y[3][kWarpBatch];
    float strain[kWarpBatch];  ///< of the response: sqrt((e1^2 + e2^2) / 2) of its principal strains e1, e2
};

/// How a face turns (rotation vector) and strains (row by row), beyond what the whole body is stretched by.
struct FaceStrain {
    float w[3], e[9], normal[3];
    float weight;  ///< by its size, 0...1
};

/// Triangles of a batch that follow a face, by these parts.
struct FollowBatch {
    std::int32_t batch, face;
    float part[kWarpBatch];
};

/// Targets of `count` batches by the gradient of `displacement` over `base`, on a free surface, and by the faces that they follow (ascending by batch); adds the
/// forces of triangles that are at `at` towards them to `force`. The largest strain.
float pullToResponse(const WarpBatch* batches, std::size_t count, const FollowBatch* follow, std::size_t followCount, const FaceStrain* faces,
                     const float* base, const float* displacement, const float* at, TargetBatch* targets, float* force);

/// Adds the forces towards the targets, turned to where the triangles are, as near as rotations go.
void pullToFit(const WarpBatch* batches, std::size_t count, const float* at, const TargetBatch* targets, float* force);

/// Adds the rotation vectors of `triangles` triangles, that their gradient says, to sum (x y z).
void addRotations(const WarpBatch* batches, std::size_t triangles, const float* base, const float* displacement, float* sum);

/// Adds the normals of triangles, of twice their areas, to each of their vertices, and these lengths to the fourth numbers.
void addNormals(const SurfaceBatch* batches, std::size_t count, const float* at, float* normals);

/// The volume within a surface whose vertices have gone from `at` by s times `way` is a cubic of s.
struct VolumeCurve {
    double volume, slope, square, cube;  ///< factors of 1, s, s^2 and s^3
    [[nodiscard]] double operator()(double s) const { return volume + s * (slope + s * (square + s * cube)); }
};
VolumeCurve volumeCurve(const SurfaceBatch* batches, std::size_t count, const float* at, const float* way);

}  // namespace imomushi
