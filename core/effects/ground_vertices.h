// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/character/element_runtime.h"

namespace imomushi {

/// Vertices of an element of which one is near the lowest of its group in any direction, at rest and bent. groupOf: per body vertex, -1: not to be chosen. most: of a
/// group. Ascending.
std::vector<std::int32_t> lowestVertices(const ElementRuntime& element, const std::vector<int>& groupOf, std::size_t most);

}  // namespace imomushi
