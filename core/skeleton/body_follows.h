// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Sets Skeleton::Bone::upright of all bones, so that an end that is dragged moves its limb before the trunk leans. It is proportional to the square of the length of bones on the shorter
/// side of the bone: large in the trunk, small in a hand. `amount`: 0 turns it off; 1 is what make-soft sets; more is stiffer.
void letBodyFollow(Skeleton& skeleton, double amount);

}  // namespace imomushi
