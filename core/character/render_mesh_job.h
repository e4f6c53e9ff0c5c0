// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/character/aligned_buffer.h"
#include "core/character/character.h"
#include "core/character/frame_job.h"
#include "core/character/render_mesh_tables.h"
#include "core/reduction/embedded_mapping.h"

namespace imomushi {

struct ElementState;

/// The render meshes of a character: the last job of a frame. Embedded points of elements that are a product come with it (ResponseBlocks); those of
/// elements that are more follow the surface here, and what a finger dents is carried to them. Joints add their part, attached parts are placed, and vertices are
/// put into the order of the file, where morph targets move them (MorphTables).
class RenderMeshJob final : public FrameJob {
public:
    /// `known`: of characters before, whose tables may fit.
    RenderMeshJob(const Frame& frame, std::span<const RenderMeshJob* const> known);

    void run(Stage stage, Frame& frame) override;
    void report(Frame&, double) const override {}  // within the times of the product and of normals
    [[nodiscard]] std::size_t bytes() const override;

    [[nodiscard]] Character::Surface surface(int mesh) const;
    /// Somebody else deforms elements of it: its surface is not that of the last frame.
    [[nodiscard]] bool pending(int mesh) const { return meshes_[static_cast<std::size_t>(mesh)].pending; }
    /// Between frames: the points of an element whose product was evaluated just now.
    void finish(Frame& frame, std::size_t element);
    /// Between frames, when its elements are finished: makes its surface.
    void catchUp(Frame& frame, int mesh);
    /// In double precision: see Character::renderPositions(). bodies: Character::positions() of the elements that it has vertices of, else empty.
    [[nodiscard]] Points positions(const Frame& frame, int mesh, const std::vector<Points>& bodies) const;
    /// Weights of the morph targets of a mesh at rest.
    [[nodiscard]] std::vector<double> restWeights(int mesh) const;
    [[nodiscard]] const RenderMeshTables& tables(int mesh) const { return *meshes_[static_cast<std::size_t>(mesh)].tables; }

private:
    enum class Carry { Nothing, Bodies, Dents };
    struct Element {
        std::size_t index = 0;
        std::shared_ptr<const EmbeddedTables> tables;
        EmbeddedMapping::Gradients gradients;
        AlignedBuffer<float> dents;  // #body vertices x 3, m, in the frame of the element; where it feels touch
        Carry carry = Carry::Nothing;
        std::size_t partBlocks = 0, partJoints = 0;  // where the frames of attached parts begin: of its blocks, and in EmbeddedMapping::jointParts()
        // Where joints place vertices otherwise than v says (the basis "paper" loses twist, v is empty without a response), points near them follow.
        Eigen::MatrixXd heldColumns;         // 3 #held x columns of v
        Eigen::VectorXd heldMoves;           // 3 #held, in the frame of the element
        Points missing;                      // #held x 3, m, world
        std::vector<std::int32_t> heldOf;    // per EmbeddedMapping::heldParts(): in ElementState::held; none: v says all
    };
    struct Mesh {
        std::shared_ptr<const RenderMeshTables> tables;
        AlignedBuffer<float> positions, normals;
        std::uint64_t revision = 0;
        std::optional<MorphShapes> morphs;   // none: it has no morph targets
        std::vector<double> shownWeights;    // of these, as of the last frame
        bool morphed = false;                // the positions of the last frame have some of them
        bool wasMorphed = false;             // those of the frame before
        bool others = false;                 // weights, in this frame
        bool all = false;                    // every vertex is another in this frame
        bool pending = false;
    };
    struct Piece {
        std::size_t element = 0, begin = 0, end = 0;
    };
    void follow(Frame& frame);
    // What comes after the product, and after what carries points.
    static void finish(Element& element, Frame& frame);
    // Where attached parts are, of an element that somebody else deforms.
    static void findParts(const Element& element, const Frame& frame, ElementState& of);
    // In double precision, as ElementState::positions; those of the body are left out.
    static Points elementPositions(const Frame& frame, const Element& element);
    // How much of its points is a product, besides what carries them.
    static double productPart(const Element& element, const ElementState& of);
    static void findDents(Element& element, const ElementState& of);
    static Element madeFor(const Frame& frame, std::size_t index);
    static void findMissing(Element& element, const Frame& frame);
    static void addJointParts(const Element& element, const Frame& frame, ElementState& of, std::size_t first = 0);
    static void placeAttached(const Element& element, ElementState& of);
    void gather(Frame& frame);
    void gather(const Frame& frame, const Piece& runs);
    void findNormals(const Frame& frame, const Piece& normals);
    // Morph targets: which meshes have other weights than before; elements are deformed here while they show.
    void findMorphed(Frame& frame);
    void findNormals(Frame& frame);

    std::vector<Element> elements_;
    std::vector<Mesh> meshes_;
    std::vector<Piece> triangles_, vertices_, points_;              // of elements_
    std::vector<Piece> runs_, normals_;                             // of meshes_: indices into RenderMeshTables::runs; begin of normals_: a piece of theirs
    std::size_t carriedBytes_ = 0;
};

}  // namespace imomushi
