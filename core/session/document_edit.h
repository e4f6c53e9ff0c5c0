// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/document/character_input.h"
#include "core/live/live_character.h"
#include "core/project/document_responses.h"
#include "core/session/services.h"

namespace imomushi {

/// All that a command that changes the document can reach: the document itself, and questions that it may ask of the rest. It is taken back whole when the command
/// fails.
class DocumentEdit {
public:
    DocumentEdit(Document& edited, LiveCharacter& live, const DocumentResponses& responses, const Services& slow) : document(edited), services(slow), live_(live), responses_(responses) {}

    Document& document;
    const Services& services;

    /// The plan of the document as it is at this moment of the change. Errors: those of planCharacter().
    Result<std::shared_ptr<const CharacterPlan>> planned() const { return live_.planOf(document); }
    /// The plan of the character that is shown. For changes of the pose, which leave it as it is. Errors: those of LiveCharacter::built().
    Result<const CharacterPlan*> shownPlan() const {
        if (auto alive = live_.built(); !alive) return tl::unexpected(alive.error());
        return &live_.plan();
    }
    /// Where an endpoint is shown, m. Errors: those of LiveCharacter::built().
    Result<Vec3> positionOf(const EndpointRef& end) const { return live_.positionOf(end); }
    /// Where a handle is shown, in the world; and a pose in the world relative to what carries it. Errors: those of LiveCharacter.
    Result<HandlePose> poseOf(const FaceRef& handle) const { return live_.poseOf(handle); }
    Result<HandlePose> carried(const FaceRef& handle, const HandlePose& world) const { return live_.carried(handle, world); }
    [[nodiscard]] const DocumentResponses& responses() const { return responses_; }

    /// A response comes with an element from another project. The session takes it in when the command has succeeded.
    void bring(PartId element, StoredResponse response) { brought_.emplace_back(element, std::move(response)); }
    [[nodiscard]] const std::vector<std::pair<PartId, StoredResponse>>& brought() const { return brought_; }

private:
    LiveCharacter& live_;
    const DocumentResponses& responses_;
    std::vector<std::pair<PartId, StoredResponse>> brought_;
};

}  // namespace imomushi
