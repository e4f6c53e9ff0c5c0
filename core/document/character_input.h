// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/character/character.h"
#include "core/document/document.h"

namespace imomushi {

class EmbeddedModels;

/// A document as a live character sees it, indices instead of names, and the way back. Responses are left null, and render meshes of characters with their rigid parts out.
struct CharacterPlan {
    CharacterInput input;
    std::vector<PartId> elements;         ///< of input.elements
    std::vector<PartId> bones;            ///< of input.skeleton.bones
    std::vector<PartId> joints;           ///< of input.joints, 0: a face that is not joined
    std::vector<PartId> characters;       ///< of input.renderMeshes
    std::map<EndpointRef, int> points;    ///< joint point of each endpoint
    std::vector<FaceRef> handles;         ///< of input.handles
    /// A rigid part of a character, and where it is: of EmbeddedPoints::attached of an element.
    struct Rigid {
        PartRef part;
        int element = 0, index = 0;
    };
    std::vector<Rigid> rigid;
    std::vector<std::string> warnings;    ///< what the artist should know, one sentence each

    [[nodiscard]] int elementIndex(PartId element) const;
    [[nodiscard]] int boneIndex(PartId bone) const;
    [[nodiscard]] int handleIndex(const FaceRef& handle) const;
    [[nodiscard]] int pointIndex(const EndpointRef& end) const;
};

/// Endpoints become joint points: an endpoint at another endpoint is that point, endpoints at joined faces are one point, and so are
/// endpoints closer than 1e-9 of the skeleton's size. The first bone created is the root of its tree unless a parent is given.
/// Errors: "zero-length", "bone-loop", "bad-place" (an endpoint that refers to what is not there, or to itself).
Result<CharacterPlan> planCharacter(const Document& document);

/// Adds the render meshes of the document's characters to its plan.
void addRenderMeshes(CharacterPlan& plan, const Document& document, EmbeddedModels& models);

/// Where a place is at rest, m. Errors: "bad-place".
Result<Vec3> restPosition(const Document& document, const Bone::Place& place);

}  // namespace imomushi
