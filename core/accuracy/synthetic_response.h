// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/character/character.h"

namespace imomushi {

/// A synthetic response: matrices of the sizes that a precompute would give, filled without one. A frame takes as long with it as with the true response; the
/// deformation means nothing. The motion of each joint face is spread over the element by inverse square distance from the planes of its faces, and the
/// stiffness is the identity. `loads`: with columns of body loads too.
std::shared_ptr<const ElementResponse> syntheticResponse(const ElementMesh& mesh, const std::vector<JointFace>& faces, const BasisChoice& basis, bool loads);

/// The character with synthetic responses, in its basis, for all elements that have joint faces.
CharacterInput withSyntheticResponses(CharacterInput input);

}  // namespace imomushi
