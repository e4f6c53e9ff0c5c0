// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/character/character.h"

namespace imomushi {

/// The outer surface of a character as one mesh over all elements: vertices welded at joints are one, triangles inside joints are left out. It is open where
/// joined faces are not welded. Skins of bones are made on it.
struct WeldedSurface {
    Points vertices;                  ///< body vertices of all elements, one element after another, rest, m
    std::vector<int> first;           ///< per element: its first vertex; one more entry
    std::vector<std::int32_t> same;   ///< per vertex: the lowest of those welded to it, itself included
    Triangles triangles;              ///< those that are seen (not inside a joint); corners are lowest vertices
    /// Per vertex: the vertex of `triangles` whose weights it takes: `same` of it, or the nearest one where it is inside a joint.
    std::vector<std::int32_t> weightOf;
};

/// `hidden`: finds what vertices inside joints take their weights from, too; else `weightOf` is empty.
WeldedSurface weldedSurface(const CharacterInput& input, bool hidden = true);

}  // namespace imomushi
