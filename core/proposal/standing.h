// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/proposal/proposal.h"

namespace imomushi {

/// Pins the ends of those bones whose flesh stands on the ground, the lowest place of the body along y: feet, also where they are not equally low. Of a body
/// that is its own mirror image, a tail that touches the ground between its feet stays free. What stands on nothing, or lies on the ground with its trunk, is
/// held at the start of its root. `tips`: bones that end limbs. Pieces are those of the proposal's cuts.
void pinStanding(Proposal& proposal, const std::vector<int>& tips, const TriangleMesh& body);

}  // namespace imomushi
