// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/document/document.h"

namespace imomushi {

/// The rim of a patch of triangles as closed loops of vertices.
using RimLoops = std::vector<std::vector<std::int32_t>>;
RimLoops rimLoops(const Triangles& triangles, std::span<const std::int32_t> patch);

/// The same of each joint face of an element, found once.
std::shared_ptr<const std::vector<RimLoops>> rimsOf(const std::shared_ptr<const Element>& element);

}  // namespace imomushi
