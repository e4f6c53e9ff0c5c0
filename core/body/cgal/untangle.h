// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/mesh/mesh.h"

namespace imomushi {

/// A closed, manifold surface that crosses itself, with its triangles around the crossings replaced by others that do not cross; other vertices keep their coordinates.
/// None where CGAL finds none, or where it encloses more than 1 % more or less.
std::optional<TriangleMesh> untangled(const TriangleMesh& mesh);

/// The outer side of a closed, manifold surface that crosses itself: its triangles split where they cross, without those that lie within the flesh. What overlaps is one. It may touch
/// itself in edges and vertices. None where CGAL finds none, or nothing is enclosed.
std::optional<TriangleMesh> outerSide(const TriangleMesh& mesh);

}  // namespace imomushi
