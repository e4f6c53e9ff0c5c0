// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/character/character.h"

namespace imomushi {

/// An element that follows its bone rigidly from its only joint: it has a single joint face, and a bone of it ends there.
bool hangsOnItsJoint(const CharacterInput::Element& element, const CharacterInput::Joint& joint);

/// Lateral contraction of joints: per joint c in a = b = 1 + c s, s = mean outward shift of its faces (m), 1/m. All bones straight and stretched by the same part of their
/// length: the in-plane stretches of all joints that minimise the sum of 1/2 v^T K v over the elements (times their stiffness), divided by the
/// shifts (the manual's model, "Balance at joints"). 0 where no adjacent element has a response or nothing shifts.
std::vector<double> leastEnergyContractions(const CharacterInput& input);

}  // namespace imomushi
