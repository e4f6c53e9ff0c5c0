// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// The limit that a bone has come to.
enum class BoneLimit { None, Stretched, Shortened, Bent };

/// Of a bone of a skeleton in a pose of it: it is so near to a limit of its length, or of the angle to its parent, that it gives way no more to speak of. None at rest.
BoneLimit limitOf(const Skeleton& skeleton, const Pose& pose, int bone);

}  // namespace imomushi
