// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/character/character.h"
#include "core/character/element_runtime.h"

namespace imomushi {

/// Errors: "bad-value": indices that name nothing, numbers that are none, a response of another mesh. What `known` runtimes are made of is not looked at again, nor render meshes of
/// `checked` inputs of the same elements.
Result<void> checkInput(const CharacterInput& input, const ElementRuntimes& known, const std::vector<const CharacterInput*>& checked);

}  // namespace imomushi
