// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

struct WrapSetting {
    std::function<double(const Vec3&)> alpha;  ///< radius of the ball that rolls there; changes slowly against itself
    /// The radius of one that rolls only over places that are outside; empty: the ball of alpha rolls everywhere alone.
    std::function<double(const Vec3&)> alphaOutside;
    std::function<bool(const Vec3&)> outside;  ///< whether a place is outside for certain
    double coarsest = 0.0;                     ///< the largest that alpha answers
    double offset = 0.0;                       ///< distance of the wrap from the triangles
    std::size_t mostVertices = 0;              ///< at which it gives up
};

/// A closed surface around triangles of any kind (Portaneri et al. 2022), everywhere `offset` away from them, or over what neither ball fits into.
/// Errors: "too-large" (more vertices than the setting allows), "no-volume", "cancelled".
Result<TriangleMesh> wrapTriangles(const TriangleMesh& mesh, const WrapSetting& setting, const Progress& progress);

}  // namespace imomushi
