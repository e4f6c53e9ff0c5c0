// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/proposal/proposal.h"
#include "core/mesh/mesh.h"
#include "core/mesh/rig.h"

namespace imomushi {

inline constexpr double kLeastRigShare = 0.01;  ///< of the flesh of a bone, unless somebody says another

/// Proposes cuts and bones from the skeleton of a file. Bones that move less than `least` of the flesh (0...1; none: kLeastRigShare, or more where that would leave many; a fifth of it is enough for limbs of a human and for hair that swings) are merged into what carries them (mergeRig()), and so
/// are those where no cut works; each one that stays is cut from its parent at its head, along the bisector of the two, or where the skin goes over from one to the other if the
/// bisector would cut through much flesh of both or works together with others nowhere; limbs come before spines. Where body and skeleton mirror themselves, so do the cuts. Bones start where those of the file do, bit for bit, so that clips move them exactly; they have their names. All cuts
/// were tried and work together. `render`: the mesh that the weights of the rig are for. The same input gives the same bytes.
/// `chosen`: the bones of the rig that stay, all others are merged, whatever flesh they move; none: as `least` says. One at which no cut works is merged all the same, and one bone stays at least.
/// Errors: "not-closed", "cancelled".
Result<Proposal> proposeFromRig(const Rig& rig, const TriangleMesh& render, const TriangleMesh& body, std::optional<double> least, const Progress& progress,
                                const std::optional<std::vector<int>>& chosen = {});

}  // namespace imomushi
