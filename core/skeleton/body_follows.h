// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Sets Skeleton::Bone::upright of all bones so that limbs move before the trunk does: the more of a character hangs on both sides of a bone, the more the bone keeps the direction of rest.
/// `amount`: 0 (none, as without it) to 1 and more.
void letBodyFollow(Skeleton& skeleton, double amount);

}  // namespace imomushi
