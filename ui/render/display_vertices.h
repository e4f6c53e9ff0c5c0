// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/character/deform_input.h"
#include "ui/render/body_geometry.h"
#include "ui/render/gl.h"

namespace imomushi::render {

/// The second stage of GpuDeformer: display vertices (BodyGeometry) with their normals from the vertices of all elements, which lie in one buffer, one
/// element after the other. Vertices are counted through all elements here. Surfaces are those of elements, then of render meshes.
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
    /// What a body shows: a surface or, of a render mesh, a part of it.
    struct Shown {
        int surface = 0;
        const std::vector<std::int32_t>* vertices = nullptr;  ///< per body vertex that of the render mesh; null: the same
    };

    /// Errors: "bad-shader".
    Result<void> prepare();
    /// Uploads the stencils of normals; `first`: per element, its first vertex.
    void upload(const DeformInput& deformInput, std::vector<std::int32_t> first);
    [[nodiscard]] Map makeMap(const Shown& shown, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const;
    /// Of a body vertex of what is shown, among those of all elements.
    [[nodiscard]] std::int32_t vertexOf(const Shown& shown, std::int32_t vertex) const { return sourceOf(shown, vertex).vertex; }
    /// Fills `vertices`: BodyGeometry::kFloats per display vertex. `elementFrame`: the uniform buffer of its element; `positions`: texture of all vertices.
    void write(const Map& map, GLuint elementFrame, GLuint positions, GLuint vertices) const;
    void clear();

private:
    /// As display_vertices.vert reads it.
    struct Source {
        std::int32_t vertex, kind, one, two;
        float part;
    };
    Program program_;
    /// Of a vertex of a surface: the element's, or that of the render mesh.
    [[nodiscard]] const Source& sourceOf(const Shown& shown, std::int32_t vertex) const;

    std::vector<std::int32_t> first_;     ///< per surface, into sources_
    Buffer stencils_, stencilParts_;
    TextureName stencilsTexture_, stencilPartsTexture_;
    std::vector<Source> sources_;  ///< per vertex of all elements, then of all render meshes: where it is, and its normal
};

}  // namespace imomushi::render
