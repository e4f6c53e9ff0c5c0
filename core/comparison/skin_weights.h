// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/character/welded_surface.h"

namespace imomushi {

/// Which bones each vertex of a skin follows: eight at most, so that none jumps where many are near.
struct SkinWeights {
    static constexpr int kMax = 8;
    struct Vertex {
        std::array<std::int32_t, kMax> bone{};
        std::array<float, kMax> weight{};  ///< descending, sum 1, >= 0
    };
    std::vector<Vertex> vertices;
    double seconds = 0.0;   ///< wall time
    double dropped = 0.0;   ///< largest part of a vertex's weights that went to a ninth bone and beyond, before they were brought to sum 1
    int unseen = 0;         ///< automatic: vertices with no bone in line of sight, whose weights diffuse from their neighbours
    double residual = 0.0;  ///< automatic: of the solution, relative

    [[nodiscard]] std::size_t bytes() const { return vertices.size() * sizeof(Vertex); }
};

/// By hand, as an artist paints a simple limb: a vertex belongs to its nearest bone and passes over to each bone that meets it in a smooth ramp across
/// the plane between the two. `length` (m): of all ramps; 0: by the body's diameter at each joint.
/// Errors: "no-bone", "bad-value", "too-small" (a body without vertices).
Result<SkinWeights> rampWeights(const WeldedSurface& body, const Skeleton& skeleton, double length);

/// Bone heat (Baran and Popovic, "Automatic rigging and animation of 3D characters", SIGGRAPH 2007, section 4): L w + H w = H p, L the surface Laplacian, H
/// = .3 / squared distance to the nearest bone that a vertex sees from inside.
/// Errors: "no-bone", "too-small", "no-heat" (a part of the surface sees no bone), "not-solved", "cancelled".
Result<SkinWeights> automaticWeights(const WeldedSurface& body, const Skeleton& skeleton, const Progress& progress);

}  // namespace imomushi
