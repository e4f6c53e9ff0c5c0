// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/export/gltf_writer.h"

namespace imomushi {

/// How the normals of a surface move per unit of each of its targets, 3 per vertex: linear, from triangles of the moved body or mesh of the scene. Of a mesh those count that
/// are at the place of the vertex and face as its normal does, so that edges that are hard in the file stay so.
std::vector<std::vector<float>> normalTargets(const GltfContent& content, const RenderSurface& surface);

}  // namespace imomushi
