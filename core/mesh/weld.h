// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// For each vertex the vertex that stands for it: the lowest one at exactly the same place (-0 is 0) and of the same group, itself where it is
/// no candidate. `group`: per vertex, or empty: all are of one group.
std::vector<std::int32_t> weldExact(const Points& points, const std::vector<char>& candidate, const std::vector<std::int32_t>& group);

/// For each of `points` the lowest of `others` at exactly the same place, -1: none.
std::vector<std::int32_t> samePlaces(const Points& points, const Points& others);

/// As weldExact() for places up to `tolerance` apart: each candidate joins the lowest earlier one that stands for itself and is in reach.
std::vector<std::int32_t> weldNear(const Points& points, const std::vector<char>& candidate, double tolerance);

}  // namespace imomushi
