// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>

#include "core/document/document.h"

namespace imomushi {

/// Parts that cannot be moved without each other at rest.
struct HangingParts {
    std::set<PartId> elements, characters, bones;
};

/// What hangs together with these elements, characters and bones: elements that are joined, pieces of one character, bones that run through them, end at them or at each
/// other, and handles that hang on bones.
HangingParts hangingTogether(const Document& document, const std::set<PartId>& parts);

/// The middle of the box of elements, or where there are none of the ends of bones, at rest, m.
Vec3 middleOf(const Document& document, const HangingParts& parts);

}  // namespace imomushi
