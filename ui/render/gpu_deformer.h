// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "core/character/deform_input.h"
#include "ui/render/body_geometry.h"
#include "ui/render/display_vertices.h"
#include "ui/render/element_bounds.h"
#include "ui/render/gl.h"

namespace imomushi::render {

/// Deforms one character on the GPU. What never changes lies in its memory: rest positions, A' and the stencils of normals in texture buffers. A frame
/// uploads joint parameters and the frames of elements, and the vertices of the few elements that the processor deforms.
///
/// Two stages of transform feedback: vertices of all elements (of their bodies, and embedded points) into one buffer, then display vertices (DisplayVertices)
/// with their normals, which gather from it, across seams too. Surfaces are those of elements, then of render meshes. Everything that draws bodies stays as it is, and bodies drawn in six passes are deformed once. Texture buffers and
/// transform feedback are part of OpenGL 3.3: storage buffers and compute shaders (4.3) would leave out macOS and older cards, and gain nothing: every
/// vertex reads its own A' once.
///
/// A context must be current wherever it is used; binding points it touches are left at OpenGL's defaults, but for the framebuffer, which is its own.
class GpuDeformer {
public:
    using DisplayMap = DisplayVertices::Map;
    using Neighbour = DisplayVertices::Neighbour;
    using Shown = DisplayVertices::Shown;

    /// Errors: "bad-shader" with the compiler's log, "no-opengl" where there is no memory at all.
    Result<void> prepare();

    /// Uploads a character, unless it is the one that is there. False: the driver has no room for it.
    bool upload(const DeformInput& deformInput);
    /// The GPU can deform this element of the uploaded character.
    [[nodiscard]] bool supports(int element) const { return elements_[static_cast<std::size_t>(element)].supported; }
    [[nodiscard]] std::uint64_t characterId() const { return id_; }  ///< DeformInput::id of the uploaded one, 0: none

    /// Vertices of all elements that changed.
    void deform(const DeformInput& deformInput);
    /// modelVertices: Body::modelVertices, which elements have no use for.
    [[nodiscard]] Shown shownBy(int surface, const std::vector<std::int32_t>* modelVertices) const { return {surface, isMesh(surface) ? modelVertices : nullptr}; }
    /// Counts the changes of a surface and of what its normals follow from.
    [[nodiscard]] std::uint64_t version(int surface) const { return isMesh(surface) ? meshOf(surface).version : elements_[static_cast<std::size_t>(surface)].version; }
    [[nodiscard]] const BoundingBoxes& bounds(int surface) const { return isMesh(surface) ? meshOf(surface).bounds : elements_[static_cast<std::size_t>(surface)].bounds; }

    [[nodiscard]] DisplayMap makeDisplayMap(const Shown& shown, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const {
        return display_.makeMap(shown, geometry, neighbours);
    }
    /// Fills `vertices`: BodyGeometry::kFloats per display vertex.
    void writeDisplayVertices(int surface, const DisplayMap& map, GLuint vertices) const;

    /// Reads vertices [first, first + count) of an element: x 3, m, world. Waits for the GPU.
    void readBack(int element, int first, int count, float* positions) const;
    /// The same of one body vertex of what is shown.
    void readVertex(const Shown& shown, std::int32_t vertex, float* position) const { read(display_.vertexOf(shown, vertex), 1, position); }
    /// Frees all memory.
    void clear();

    /// Of the last deform().
    struct Stats {
        int deformed = 0;          ///< elements that the GPU deformed
        int copied = 0;            ///< elements that the processor deformed
        std::size_t uploaded = 0;  ///< bytes
    };
    [[nodiscard]] const Stats& stats() const { return stats_; }

private:
    struct ElementBuffers {
        int first = 0, vertices = 0, faces = 0, places = 0;  ///< `first`: in the buffer of all vertices
        bool supported = false;
        int modeVectors = 0, shapeVectors = 0;  ///< modes and shapes come in vectors of four
        bool integers = false;                  ///< A' is of 16-bit integers
        VertexArray vertexArray;
        Buffer rest, held, offsets, response, shapes, frame;
        TextureName responseTexture, shapesTexture;
        std::vector<float> frameNumbers;  ///< the uniform block ElementState
        ElementBounds boundsOf;
        std::vector<int> neighbours;      ///< elements whose vertices its normals on seams read
        std::vector<std::int32_t> seen;   ///< under render meshes: the vertices that they need, ascending; empty: those of the body
        std::uint64_t revision = 0, version = 0;
        bool fresh = true, changed = false;
        bool needed = true;               ///< a surface of this frame is made from it
        BoundingBoxes bounds;
    };
    struct MeshState {
        std::vector<std::int32_t> elements;
        std::uint64_t version = 0;
        BoundingBoxes bounds{};  ///< of its elements
    };
    [[nodiscard]] bool isMesh(int surface) const { return surface >= static_cast<int>(elements_.size()); }
    [[nodiscard]] const MeshState& meshOf(int surface) const { return meshes_[static_cast<std::size_t>(surface) - elements_.size()]; }
    void read(int first, int count, float* positions) const;
    void uploadElement(const DeformInput::Element& element, ElementBuffers& buffers) const;
    void uploadFrame(const DeformInput::Element& element, ElementBuffers& buffers);
    void uploadPositions(const DeformInput::Element& element, ElementBuffers& buffers);

    Program deform_;
    DisplayVertices display_;
    Target unused_;  ///< OpenGL wants a framebuffer even where nothing is drawn
    std::uint64_t id_ = 0;
    bool uploaded_ = false;
    std::vector<ElementBuffers> elements_;
    std::vector<MeshState> meshes_;
    Buffer positions_;  ///< vertices of all elements, x 4
    TextureName positionsTexture_;
    std::vector<float> staging_;
    Stats stats_;
};

}  // namespace imomushi::render
