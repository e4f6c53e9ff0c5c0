// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/document/effects.h"
#include "core/mesh/health.h"
#include "core/mesh/render_model.h"
#include "core/mesh/rig.h"

namespace imomushi {

/// A plane that cuts the body of a character.
struct Cut {
    PartId id = 0;
    std::string name;
    CutPlane plane;
    bool visible = true;  ///< false: not drawn and not picked in the viewport
    bool locked = false;  ///< not picked or changed there
};

/// How a part of what is seen follows the body, where the artist has chosen it.
struct Attachment {
    /// Flesh: each vertex follows the surface beside it. Rigid: the part keeps its shape and moves as the body does at its pivot.
    enum class Mode { Flesh, Rigid } mode = Mode::Flesh;
    std::optional<Vec3> pivot;  ///< m, at rest; of a rigid part, which turns about it. None: the middle of its box
    PartId element = 0;         ///< that it follows; 0, or one that the character has no more: chosen from where it is
    bool operator==(const Attachment&) const = default;
};

/// A whole character: what is seen of it, the closed body that moves that, and the cuts that make elements of the body. All cuts are applied together to the whole
/// body, so that each can be moved or taken out at any time. A cut into two pieces per plane: a character of n cuts has n + 1 elements.
struct CharacterSource {
    PartId id = 0;
    std::string name;
    std::shared_ptr<const RenderModel> model;
    std::shared_ptr<const Body> body;
    std::shared_ptr<const Rig> rig;   ///< the skeleton that came with the file or was imported for it, or clips of morph targets alone; null: none
    std::vector<Cut> cuts;            ///< in order of creation
    std::vector<MeshIssue> issues;    ///< as found on import; places are those of the model
    std::map<ModelPart, Attachment> attachments;  ///< what is not here follows as its part does, or by itself (embedModel())

    [[nodiscard]] int cutIndex(PartId cut) const;  ///< -1: no such cut
    [[nodiscard]] int cutIndex(std::string_view cut) const;
};

/// A side of a cut that bounds an element.
struct CutSide {
    PartId cut = 0;
    bool front = false;  ///< the element lies where the normal of the plane points
    std::string face;    ///< the joint face on that side, empty: it was removed
    bool operator==(const CutSide&) const = default;
};

/// Where a piece of a body comes from, see BodyPiece.
struct PieceOrigin {
    std::vector<std::int32_t> vertices;   ///< per vertex of the element's body that of the whole body, -1: made by a cut
    std::vector<std::int32_t> triangles;  ///< per triangle that of the whole body that it lies on, -1: of a cut
};

/// What an element is of a character. Its sides tell it from the other elements of the character.
struct CharacterPiece {
    PartId character = 0;
    std::vector<CutSide> sides;  ///< ascending by cut; none: the whole body
    std::shared_ptr<const PieceOrigin> origin;

    [[nodiscard]] int sideIndex(PartId cut) const;  ///< -1: the cut does not bound it
};

}  // namespace imomushi
