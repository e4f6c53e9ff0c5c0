// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/character/surface_recipe.h"
#include "ui/render/body_geometry.h"
#include "ui/render/gl.h"

namespace imomushi::render {

/// Makes the surfaces of one character on the graphics card. What never changes lies in its memory: rest positions, A' and the stencils of normals in
/// texture buffers. A frame uploads joint parameters and the frames of elements, and all of the few elements that the processor deforms.
///
/// Two passes of points without a picture, whose results are kept by transform feedback: body vertices of all elements into one buffer, then display
/// vertices (BodyGeometry) with their normals, which gather from it, across seams too. Everything that draws bodies stays as it is, and bodies drawn
/// in six passes are deformed once. Texture buffers and transform feedback are part of OpenGL 3.3: storage buffers and compute shaders (4.3) would leave out
/// macOS and older cards, and gain nothing: every vertex reads its own A' once.
///
/// A context must be current wherever it is used; binding points it touches are left at OpenGL's defaults, but for the framebuffer, which is its own.
class CardDeformer {
public:
    /// Errors: "bad-shader" with the compiler's log, "no-opengl" where there is no memory at all.
    Result<void> prepare();

    /// Takes over a character, unless it is the one it has. False: the driver has no room for it.
    bool take(const SurfaceRecipe& recipe);
    /// Of the character it has: the card can make this element.
    [[nodiscard]] bool fits(int element) const { return parts_[static_cast<std::size_t>(element)].fits; }
    [[nodiscard]] std::uint64_t id() const { return id_; }  ///< of its recipe, 0: none

    /// Body vertices of all elements of its character that changed.
    void deform(const SurfaceRecipe& recipe);
    /// Counts the changes of an element and of what its normals follow from.
    [[nodiscard]] std::uint64_t version(int element) const { return parts_[static_cast<std::size_t>(element)].version; }
    /// World, m.
    struct Bounds {
        Eigen::AlignedBox3f holds;  ///< all of it, up to some percent larger
        Eigen::AlignedBox3f about;  ///< as large as it, within some tenths of a percent
    };
    [[nodiscard]] const Bounds& bounds(int element) const { return parts_[static_cast<std::size_t>(element)].bounds; }

    /// Where display vertices of one body come from.
    struct Dress {
        VertexArray vertexArray;
        Buffer source, corners;
        TextureName cornersTexture;
        int count = 0;
    };
    /// A body whose welded vertices share the normals of groups.
    struct Neighbour {
        const BodyGeometry* geometry = nullptr;
        int element = 0;
        std::vector<std::pair<std::int32_t, std::int32_t>> welded;  ///< own body vertex, its
    };
    [[nodiscard]] Dress makeDress(int element, const BodyGeometry& geometry, const std::vector<Neighbour>& neighbours) const;
    /// Fills `vertices`: BodyGeometry::kFloats per display vertex.
    void dress(int element, const Dress& dress, GLuint vertices) const;

    /// Reads back body vertices [first, first + count) of an element: x 3, world. Waits for the card.
    void read(int element, int first, int count, float* positions) const;
    void forget();

    /// Of the last deform().
    struct Stats {
        int deformed = 0;          ///< elements whose vertices the card made
        int copied = 0;            ///< elements whose vertices the processor made
        std::size_t uploaded = 0;  ///< bytes
    };
    [[nodiscard]] const Stats& stats() const { return stats_; }

private:
    /// Vertices that are near each other at rest, for bounds.
    struct Cluster {
        Eigen::AlignedBox3f rest;
        Eigen::Vector3f mean;
        Eigen::Matrix3Xf middleOf, halfOf, meanOf;  ///< per mode
    };
    struct Part {
        int first = 0, vertices = 0, faces = 0;
        bool fits = false;
        int quads = 0, shapeQuads = 0;  ///< fours of modes and of shapes
        bool integers = false;
        VertexArray vertexArray;
        Buffer rest, held, response, shapes, drive;
        TextureName responseTexture, shapesTexture;
        std::vector<float> numbers;  ///< of the block Drive
        std::vector<Cluster> clusters;
        std::vector<int> someHeld;
        std::vector<int> neighbours;  ///< whose points its normals on seams read
        std::uint64_t revision = 0, version = 0;
        bool fresh = true, changed = false;
        Bounds bounds;
    };
    void takeElement(const SurfaceRecipe::Element& element, Part& part) const;
    void takeNormals(const SurfaceRecipe& recipe);
    void fillDrive(const SurfaceRecipe::Element& element, Part& part);
    static void bound(const SurfaceRecipe::Element& element, Part& part);

    Program deform_, dress_;
    Target nowhere_;  ///< OpenGL wants a framebuffer even where nothing is drawn
    std::uint64_t id_ = 0;
    bool taken_ = false;
    std::vector<Part> parts_;
    Buffer points_, stencils_, stencilParts_;
    TextureName pointsTexture_, stencilsTexture_, stencilPartsTexture_;
    struct Source {
        std::int32_t vertex, kind, one, two;
        float part;
    };
    std::vector<Source> normalOf_;  ///< per point
    std::vector<float> staging_;
    Stats stats_;
};

}  // namespace imomushi::render
