// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/document/document.h"

namespace imomushi {

/// The parts that differ between two states of a document, as they are in one of the two. Undo and redo are the same exchange: what is here
/// goes into the document, and what was there comes here. A part that is absent is null.
struct DocumentChange {
    std::map<PartId, std::shared_ptr<const Element>> elements;
    std::map<PartId, std::shared_ptr<const Joint>> joints;
    std::map<PartId, std::shared_ptr<const Bone>> bones;
    std::map<PartId, std::shared_ptr<const CharacterSource>> characters;
    std::map<EndpointRef, std::optional<EndpointGoal>> goals;
    std::map<FaceRef, std::optional<HandleGoal>> handleGoals;
    std::map<PartRef, std::optional<TurnGoal>> turns;
    std::map<MorphRef, std::optional<double>> morphs;
    std::optional<CharacterSettings> settings;
    std::optional<Effects> effects;
    std::map<PartId, std::shared_ptr<const Take>> takes;
    std::optional<std::vector<Touch>> touches;
    std::optional<std::shared_ptr<const InputMappings>> mappings;
    std::optional<std::shared_ptr<const KeptPoses>> poses;
    std::optional<std::shared_ptr<const Cycles>> cycles;
    std::optional<Pose> pose;
    bool unknown = false;  ///< memory ran out while documents were compared: listeners must take it that anything differs

    /// Some part of this kind differs, or may: has(&DocumentChange::elements).
    template <class Parts>
    [[nodiscard]] bool has(Parts DocumentChange::*kind) const {
        if constexpr (requires(const Parts& parts) { parts.has_value(); })
            return unknown || (this->*kind).has_value();
        else
            return unknown || !(this->*kind).empty();
    }
    /// What responses are solved from differs.
    [[nodiscard]] bool forResponses() const { return has(&DocumentChange::elements) || has(&DocumentChange::effects) || has(&DocumentChange::settings); }
    [[nodiscard]] bool empty() const;
    /// Elements, joints, bones, characters, settings, effects, takes, mappings, kept poses or cycles differ.
    [[nodiscard]] bool structure() const;
    /// Targets of endpoints or handles, turns of parts, weights of morph targets, fingers or the pose differ.
    [[nodiscard]] bool posing() const;
};

/// What differs, as it is in `before`. Time grows with the number of parts, not with their size.
DocumentChange difference(const Document& before, const Document& after);
/// True if the documents differ in Document::pose at most. A gliding target counts as a difference.
[[nodiscard]] bool differInPoseAtMost(const Document& before, const Document& after);
void exchange(Document& document, DocumentChange& change);

/// Whether joint points can have moved: more than names and materials differ. `after`: the document that the change led to.
bool movesJointPoints(const DocumentChange& change, const Document& after);

}  // namespace imomushi
