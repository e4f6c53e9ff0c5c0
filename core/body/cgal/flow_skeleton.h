// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Lines through the middle of a body.
struct FlowSkeleton {
    std::vector<Vec3> points;                         ///< m
    std::vector<std::array<std::int32_t, 2>> edges;   ///< between points; rings of the body are rings here
    std::vector<std::vector<std::int32_t>> vertices;  ///< per point the vertices of the mesh that came together there
};

/// The skeleton to which a closed surface of one component shrinks under its mean curvature (Tagliasacchi et al. 2012, "Mean curvature skeletons"). Coordinates of about 1.
/// `shortest`: edges that the flow has made shorter than this vanish, in diagonals; 0.004 takes two thirds of the time of 0.002, CGAL's, and may shrink a head on a short neck into the shoulders. Errors: "no-skeleton" (the surface is no closed manifold of one component, or did not shrink to lines), "cancelled".
Result<FlowSkeleton> flowSkeleton(const TriangleMesh& mesh, double shortest, const Progress& progress);

}  // namespace imomushi
