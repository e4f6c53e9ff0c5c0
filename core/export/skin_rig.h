// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/export/skin_fit.h"

// Of fitSkin() alone: what the bones of a file have of a skin.
namespace imomushi {

/// Per element: the joint of the skin that leads it, -1: no rig has it. `first`: joint of the first bone of all rigs.
std::vector<int> leadingJoints(const ExportScene& scene, int first);

/// The weight of a bone is shared among all bones that its mover carries as the file shares the vertex among them, as far as kMax joints go.
void shareAmongMerged(const ExportScene& scene, const Motion& motion, int first, FittedSkin& skin);

/// Bones come first; other joints that move nothing are left out.
void orderJoints(int first, FittedSkin& skin);

}  // namespace imomushi
