// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/character/character.h"

namespace imomushi {

/// The paper's table from a run of both models on one character (the manual's model, "The previous model").
struct ModelTable {
    struct Row {
        std::string model;          ///< "proposed" or "previous"
        int elements = 0, vertices = 0;
        int columns = 0;            ///< of all elements: joint parameters g, or joint-face unknowns m
        std::size_t bytes = 0;      ///< of all matrices, as floats: n' x g of free vertices, or n x m with tractions
        std::size_t frameBytes = 0; ///< of them, what the frame reads: the engine leaves affine motions to rest positions
        double productMs = 0.0;     ///< product of all elements; the proposed one's includes placing its vertices in the world
        double frameMs = 0.0;       ///< whole frame: inverse kinematics, joints, product, positions, normals; previous: and dynamics of joint faces
        /// Vertices at 60 frames per second by frameMs per vertex: of that many elements like these.
        [[nodiscard]] double verticesAt60() const { return frameMs > 0.0 ? vertices * (1000.0 / 60.0) / frameMs : 0.0; }
    };
    /// The proposed model against the previous one's statics, displacements in the frames of the elements, on the vertices that are seen.
    struct PoseError {
        std::string pose;
        double relative = 0.0;      ///< L2
        double percent = 0.0;       ///< largest, % of its element's bounding-box diagonal
        /// The pose turns or shifts a joint face in its plane, which the basis "paper" cannot say.
        bool beyondBasis = false;
    };
    Row proposed, previous;
    std::vector<PoseError> errors;  ///< of standardPoses()
    bool diverged = false;          ///< the previous model did, while it was measured
};

/// A character that both models can run.
struct ComparedModels {
    CharacterInput input;  ///< responses of basis "paper" for all elements with joint faces
    std::vector<std::shared_ptr<const ElementResponse>> full;  ///< per element the same of basis "full", null without joint faces
};

/// Vertices that are not hidden inside a joint, per element #body vertices.
std::vector<std::vector<char>> seenVertices(const CharacterInput& input);
/// The character without its effects and on one thread, in the basis "paper", as the paper's models are. Responses stay.
CharacterInput withoutEffects(const CharacterInput& given);

/// Both run in float on one thread, in turn. Errors: those of PreviousModel, "no-face", "no-bone", "cancelled".
Result<ModelTable> compareModels(const ComparedModels& models, const Progress& progress);

}  // namespace imomushi
