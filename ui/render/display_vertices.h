// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/character/surface_recipe.h"
#include "ui/render/body_geometry.h"
#include "ui/render/gl.h"

namespace imomushi::render {

/// The second stage of GpuDeformer: display vertices (BodyGeometry) with their normals from the body vertices of all elements, which lie in one buffer, one
/// element after the other. Body vertices are counted through all elements here.
class DisplayVertices {
public:
    /// Where the display vertices of one body come from.
    struct Map {
        VertexArray vertexArray;
        Buffer sources, corners;
        TextureName cornersTexture;
        int count = 0;
    };
    /// A body whose welded vertices share the normals of groups.
    struct Neighbour {
        const BodyGeometry* geometry = nullptr;
        int element = 0;
        std::vector<std::pair<std::int32_t, std::int32_t>> welded;  ///< own body vertex, its
    };

    /// Errors: "bad-shader".
    Result<void> prepare();
    /// Uploads the stencils of normals; `first`: per element, its first body vertex.
    void upload(const SurfaceRecipe& recipe, std::vector<std::int32_t> first);
    [[nodiscard]] Map makeMap(int element, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const;
    /// Fills `vertices`: BodyGeometry::kFloats per display vertex. `elementFrame`: the uniform buffer of its element; `positions`: texture of all body vertices.
    void write(const Map& map, GLuint elementFrame, GLuint positions, GLuint vertices) const;
    void clear();

private:
    /// As display_vertices.vert reads it.
    struct Source {
        std::int32_t vertex, kind, one, two;
        float part;
    };
    Program program_;
    std::vector<std::int32_t> first_;
    Buffer stencils_, stencilParts_;
    TextureName stencilsTexture_, stencilPartsTexture_;
    std::vector<Source> normalOf_;  ///< per body vertex
};

}  // namespace imomushi::render
