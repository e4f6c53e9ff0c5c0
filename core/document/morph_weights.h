// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/document.h"

namespace imomushi {

/// The weight of a morph target as it is set, or at rest.
double morphWeight(const Document& document, const CharacterSource& character, int target);
/// A morph target by the names of its character and its own. Errors: "no-such-character", "no-such-target", with the names there are.
Result<MorphRef> morphOf(const Document& document, std::string_view character, std::string_view target);

}  // namespace imomushi
