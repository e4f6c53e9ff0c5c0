// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/prepared_surface.h"

// Of makeBody() alone.
namespace imomushi {

struct MendedSurface {
    TriangleMesh mesh;                   ///< closed, outward
    std::vector<std::int32_t> vertexOf;  ///< per vertex of the prepared mesh its vertex here, -1: none
    double volumeLeftOut = 0.0;          ///< of closed parts that the body carries, m^3
    bool whole = false;                  ///< all of the prepared mesh, triangle by triangle
    std::vector<MeshIssue> issues;
};

/// A closed body of the closed surfaces of a prepared mesh: those that cross are united, those inside of others and small ones on others left out; a
/// surface inside another that faces the other way is a cavity and stays. Errors: "not-mendable" (what is open, or crosses itself, matters), "cancelled".
Result<MendedSurface> mendedBody(const PreparedSurface& surface, const Progress& progress);

}  // namespace imomushi
