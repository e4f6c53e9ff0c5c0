// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/export/morphs.h"

namespace imomushi {

/// Rows of `track` that linear interpolation needs, the first and the last included, so that no vertex is farther than `tolerance` (m) from where it was.
std::vector<std::size_t> neededKeys(const ElementMorphs& morphs, const ElementMorphs::Track& track, double tolerance);

}  // namespace imomushi
