// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/character/character.h"

namespace imomushi {

/// Where a bone ends in the flesh of an element: two points of the skeleton.
struct FreeEnd {
    int end = 0;   ///< in no joint and no other bone
    int near = 0;  ///< the other end of its bone
};

/// The one free end of the bones of an element. Nullopt: it has none or several, or nothing holds it but its bones.
std::optional<FreeEnd> freeEndOf(const CharacterInput& input, std::size_t element);

}  // namespace imomushi
