// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/character/character.h"

namespace imomushi {

/// Milliseconds of a whole frame of the character (inverse kinematics, joints, product, positions, normals) before anything is precomputed: the median
/// of some frames with synthetic responses, on this machine, now. Fingers and what bone dynamics and the ground add are not in it.
/// Errors: those of Character::build; "cancelled".
Result<double> predictFrame(const CharacterInput& input, const Progress& progress = {});

}  // namespace imomushi
