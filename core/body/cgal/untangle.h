// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/mesh/mesh.h"

namespace imomushi {

/// A closed, manifold surface that crosses itself, with its triangles around the crossings replaced by others that do not cross; other vertices keep their coordinates.
/// None where CGAL finds none, or where it encloses more than 1 % more or less.
std::optional<TriangleMesh> untangled(const TriangleMesh& mesh);

}  // namespace imomushi
