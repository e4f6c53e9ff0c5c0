// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/session/session.h"

namespace imomushi {

/// The render mesh of a whole character as it is seen now. Pointers are into the live character: read before the session changes again.
struct SeenMesh {
    std::shared_ptr<const CharacterSource> source;
    int index = -1;                                 ///< of CharacterInput::renderMeshes; -1: the character cannot be built
    Character::Surface surface;                     ///< without positions while the character cannot be built (it is at rest), and see seenMeshes()
    std::shared_ptr<const EmbeddedMesh> embedded;   ///< null: the same
    std::vector<PartId> elements;                   ///< those that EmbeddedMesh::Vertex::element counts; without `embedded` the one that all follow

    [[nodiscard]] const RenderModel& model() const { return *source->model; }
    /// Where a vertex is now, m, world.
    [[nodiscard]] Vec3 at(std::int32_t vertex) const {
        if (!surface.positions) return model().mesh.body.vertices.row(vertex);
        const float* p = surface.positions + 3 * std::ptrdiff_t(vertex);
        return {p[0], p[1], p[2]};
    }
    [[nodiscard]] PartId elementOfVertex(std::int32_t vertex) const { return embedded ? elements[std::size_t(embedded->vertices[std::size_t(vertex)].element)] : elements.front(); }
    /// The element that a triangle follows: that of most of its corners, else that of the first. It is hidden, selected and coloured with this one.
    [[nodiscard]] PartId elementOf(std::int32_t triangle) const;
};

/// Those of all characters. drawnFrom: whoever draws from it makes the surfaces of meshes whose elements it deforms; these have no positions here.
std::vector<SeenMesh> seenMeshes(const Session& session, const DeformInput* drawnFrom = nullptr);

/// What is seen of one element of a character, as a mesh of its own.
struct RenderPart {
    PartId element = 0;
    std::shared_ptr<const ElementMesh> mesh;  ///< its body has the vertices and triangles of the render mesh that follow the element; without textures
    std::vector<std::int32_t> vertices;       ///< of the render mesh, per vertex of `mesh`, ascending
    std::vector<std::int32_t> triangles;      ///< of the render mesh, per triangle of `mesh`, ascending
};

/// The parts of a render mesh by elements. `known`: of the same render mesh before; parts whose triangles did not change keep their mesh.
std::vector<RenderPart> renderParts(const SeenMesh& seen, const std::vector<RenderPart>& known);

}  // namespace imomushi
