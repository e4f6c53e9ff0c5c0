// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// The parts of a document that differ between two of its states, as they are in one of them. Undo and redo are the same exchange: what is
/// here goes into the document, and what was there comes here. Absent parts are null.
struct DocumentChange {
    std::map<PartId, std::shared_ptr<const Element>> elements;
    std::map<PartId, std::shared_ptr<const Joint>> joints;
    std::map<PartId, std::shared_ptr<const Bone>> bones;
    std::map<EndpointRef, std::optional<Held>> held;
    std::optional<CharacterSettings> settings;
    std::optional<Effects> effects;
    std::map<PartId, std::shared_ptr<const Take>> takes;
    std::optional<std::vector<Touch>> touches;
    std::optional<Pose> pose;

    [[nodiscard]] bool empty() const;
    /// Elements, joints, bones, settings, effects or takes differ.
    [[nodiscard]] bool structure() const;
};

/// What differs, as it is in `before`. The pose counts when `withPose` or when it differs.
DocumentChange difference(const Document& before, const Document& after, bool withPose);
void exchange(Document& document, DocumentChange& change);

bool samePose(const Pose& a, const Pose& b);
bool sameSkeleton(const Skeleton& a, const Skeleton& b);

}  // namespace imomushi
