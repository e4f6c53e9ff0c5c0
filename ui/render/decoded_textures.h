// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/mesh/mesh.h"
#include "ui/render/image.h"

namespace imomushi::render {

/// The textures of a mesh as pixels; none where one cannot be decoded.
using DecodedTextures = std::vector<std::optional<Image>>;

/// Decodes the textures of a mesh that nobody has drawn yet, who would wait for that. They are kept until they are taken, or the mesh is gone. Any thread.
void decodeTextures(const std::shared_ptr<const ElementMesh>& mesh);

/// Takes what was decoded; where nothing was, decodes now. Any thread.
DecodedTextures takeTextures(const std::shared_ptr<const ElementMesh>& mesh);

}  // namespace imomushi::render
