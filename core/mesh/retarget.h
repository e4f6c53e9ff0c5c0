// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/mesh/rig.h"

namespace imomushi {

/// A clip of one skeleton for another one.
struct RetargetedClip {
    RigClip clip;                               ///< of the nodes of the figure's rig, with the name that it had; no tracks: nothing corresponds
    std::vector<std::pair<int, int>> followed;  ///< bone of the clip's rig, bone of the figure's
    std::vector<std::string> lost;              ///< bones that the clip moves and that the figure does not have
    int byNames = 0;                            ///< of those that are followed; the others by what they are of a human
    bool feet = false;                          ///< planted feet are kept in place
};

/// Bones correspond by their names, else by their names without prefixes and signs, else by what they are of a human (humanRoles()). Each turns in the world as its counterpart
/// does from its own rest; arms and legs point where those of the clip point, so that a clip whose arms hang at rest (A-pose) suits a figure whose arms are spread (T-pose).
/// Hips are moved as far as the legs of the figure are longer. While a foot of the clip stands, that of the figure stays where it is, by bending its leg.
/// A figure that looks another way is turned to. The clip has a key per frame at 60 per second, fewer where it is very long. Both rigs are sound (checkRig()).
RetargetedClip retarget(const Rig& source, const RigClip& clip, const Rig& figure);

}  // namespace imomushi
