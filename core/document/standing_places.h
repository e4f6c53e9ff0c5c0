// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// Where a body stands at rest: a point of its surface, and the radius of a disc there, m.
struct StandingPlace {
    Vec3 point = Vec3::Zero();
    double radius = 0.0;
};
/// Of the patches of a body (a closed surface, +Y up) that are not much higher than its lowest point, the largest first; few. `least`: m, radius of the smallest disc.
std::vector<StandingPlace> standingPlaces(const TriangleMesh& body, double least);

}  // namespace imomushi
