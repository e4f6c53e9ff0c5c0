// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"

namespace imomushi {

/// Where a finger can press: smooth bumps that cover the surface of an element but its joint faces and cavities. Their weights add up to 1
/// everywhere, each falls from its centre along the surface, so that a bump on one side of a thin fin never reaches through it.
struct TouchPatches {
    std::vector<std::int32_t> centre;  ///< body vertex in the middle of each
    double reach = 0.0;                ///< m, along the surface: beyond it a bump vanishes. Its width at half height is about as much
    /// Weights of body vertex v: entries first[v] ... first[v + 1] of `patch` (ascending) and `weight`. None: it cannot be touched.
    std::vector<std::int32_t> first, patch;
    std::vector<float> weight;

    [[nodiscard]] int count() const { return static_cast<int>(centre.size()); }
    /// #V x count().
    [[nodiscard]] Eigen::MatrixXd dense() const;
};

/// About `count` bumps at places as far from each other as can be (farthest-point sampling); at least one on each connected part of the free surface,
/// at most one for four vertices. None without a joint face, as nothing holds the element then. Distances run along the surface (unfolded triangle by
/// triangle, Novotni and Klein 2002). Independent of unit and place up to rounding; deterministic, one thread, about count^(1/2) n log n.
TouchPatches touchPatches(const ElementMesh& element, std::span<const JointFace> faces, int count);

/// Per triangle of a mesh with these edges, 1: it belongs neither to a face (`held`: its triangles) nor to a shell that winds inward.
std::vector<char> touchableTriangles(const TriangleMesh& mesh, const EdgeTable& edges, std::span<const std::int32_t> held);

}  // namespace imomushi
