// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/proposal/proposal.h"
#include "core/mesh/mesh.h"

namespace imomushi {

inline constexpr double kLeastShare = 5e-5;  ///< of the flesh of a piece, unless somebody says another

/// Proposes cuts, bones and pins from the shape of a body alone, +Y up: limbs are the branches of its skeleton (flowSkeleton()) that stand out of the flesh, cut at
/// their necks and then into pieces about twice as long as they are thick (longer where there would be too many); the root is where most limbs meet. All cuts
/// were tried and work together. A shape that mirrors itself gets a proposal that does. A shape without limbs gets handles. Neither depends on its size.
/// `least`: the smallest share of the flesh of a piece, 0...1. The same input gives the same bytes. Errors: "not-closed", "no-skeleton", "cancelled".
Result<Proposal> proposeFromShape(const TriangleMesh& body, double least, const Progress& progress);

}  // namespace imomushi
