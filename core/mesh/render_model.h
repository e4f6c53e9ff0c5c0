// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace imomushi {

/// What is seen of a whole character: the file's own vertices, triangles, parts, materials and texture coordinates, in the order of the file. Open, non-manifold,
/// self-intersecting: anything goes, since a body moves it. Never changed after import.
struct RenderModel {
    ElementMesh mesh;                 ///< its `body` is the file's vertices (finite) and triangles (indices in range), closed or not
    std::vector<std::int32_t> part;   ///< #F into parts
    std::vector<std::string> parts;   ///< names by the file's objects or nodes; UTF-8, not empty, not unique
};

}  // namespace imomushi
