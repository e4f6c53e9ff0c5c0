// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/body/body.h"

// Of makeBody() alone.
namespace imomushi {

/// A closed, outward surface of a mesh, and which bones move it.
struct FleshPart {
    TriangleMesh mesh;
    std::vector<std::int32_t> bone;  ///< #V, the bone that moves each vertex most, -1: none
    double volume = 0.0;             ///< m^3
    bool small = false;              ///< it is small and stands out little
};

/// What becomes of parts that do not touch each other.
struct Linking {
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;  ///< parts to be linked: they make trees
    std::vector<char> attached;                                ///< per part: it makes no flesh, the others carry it
};

/// Which parts belong together: near ones, of them first those whose bones are the same or neighbours. A part at the end of a tree is attached where it is small, or where the
/// bone that moves it moves more of another part (a backpack): it has no motion of its own. `touching`: pairs of parts that do, as many as hang them together. `parents`: of the
/// bones, may be empty. `size`: of all parts together, m. `carry`: whether any are attached.
Linking planLinks(const std::vector<FleshPart>& parts, const std::vector<std::pair<std::int32_t, std::int32_t>>& touching, const std::vector<std::int32_t>& parents, double size, bool carry, const Progress& progress);

/// A tube of flesh between two parts that do not touch.
struct LinkTube {
    TriangleMesh mesh;  ///< closed, outward, its ends within the parts
    FleshLink link;
};
/// None where the two do not face each other. `part`: radius over that of the disc in which they do.
std::optional<LinkTube> linkTube(const TriangleMesh& a, const TriangleMesh& b, double part);
/// The same where a link was asked for, and as thick.
std::optional<LinkTube> linkTube(const TriangleMesh& a, const TriangleMesh& b, const FleshLink& asked);

}  // namespace imomushi
