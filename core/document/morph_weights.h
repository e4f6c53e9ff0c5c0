// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/document.h"

namespace imomushi {

/// The weight of a morph target as it is set, or at rest.
double morphWeight(const Document& document, const CharacterSource& character, int target);

}  // namespace imomushi
