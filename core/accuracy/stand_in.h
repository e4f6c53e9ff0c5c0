// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/base/progress.h"
#include "core/character/character.h"

namespace imomushi {

/// A response of the right shape without a precompute: what its faces do is spread over the element by the distance from their planes, and its
/// stiffness is as if all joint parameters were springs of their own. A frame costs as much with it as with the true one; it deforms to nonsense.
/// `loads`: with columns of body loads too.
std::shared_ptr<const ElementResponse> standInResponse(const ElementMesh& mesh, const std::vector<JointFace>& faces, const BasisChoice& basis, bool loads);

/// The character with stand-ins in its basis for all elements that have joint faces.
CharacterInput withStandIns(CharacterInput input);

/// Milliseconds of a whole frame of the character (inverse kinematics, joints, product, positions, normals) before anything is precomputed: the median
/// of some frames with stand-ins, on this machine, now. Fingers and what bone dynamics and the ground add are not in it.
/// Errors: those of Character::build; "cancelled".
Result<double> predictFrame(const CharacterInput& input, const Progress& progress = {});

}  // namespace imomushi
