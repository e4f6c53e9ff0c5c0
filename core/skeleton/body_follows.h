// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Sets Skeleton::Bone::upright of all bones, so that an end that is dragged moves its limb before the trunk leans. It is proportional to the square of the length of bones on the shorter
/// side of the bone: large in the trunk, small in a hand. Bones that meet in the middle of one element and go on beyond it, to legs and neck, are the frame of a trunk without a bone of its own:
/// they are as large as the middle is. `amount`: 0 turns it off; 1 is what make-soft sets; more is stiffer. elementOf: per bone the element it runs through, < 0: none; empty: they are not known.
void letBodyFollow(Skeleton& skeleton, double amount, std::span<const int> elementOf = {});

}  // namespace imomushi
