// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// What stands out of a surface: a head, an ear, a tail. Lengths are in diagonals, as those of limbs.
struct SurfaceTip {
    std::int32_t vertex = 0;     ///< its end
    std::vector<Vec3> line;      ///< through its middle, from where it stands out of the rest to its end; empty: not far enough for a limb
    std::vector<double> radius;  ///< per point of the line, of its section
    double share = 0.0;          ///< of the area of the surface that lies beyond the first point of the line
};

struct SurfaceTips {
    std::vector<SurfaceTip> tips;
    std::vector<std::int32_t> tipOf;  ///< per vertex the tip that it leads to
};

/// Ends are the places from which it is farther to everywhere else, along the surface, than from all places around them; from each of them to the next one
/// it goes down by a least length first. So ends are found that a skeleton loses because they are small, flat, or beside larger ones. What is round has none.
/// `mesh`: of evenMesh(), closed, one component.
SurfaceTips findSurfaceTips(const TriangleMesh& mesh);

}  // namespace imomushi
