// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/character_input.h"
#include "core/document/document_change.h"

namespace imomushi {

/// Whether the live character must be built again. False: it stays; only numbers of its effects may have changed.
bool changesCharacter(const DocumentChange& change, const Document& after);

/// Adapts targets and pose of a document after its joint points have changed: a new skeleton starts in its rest pose, pins at rest move to the new rest pose, and targets of endpoints
/// that no longer exist are removed. `before`: null if the document had no plan. True: some target is not where the rest pose has it.
bool followSkeleton(Document& document, const CharacterPlan* before, const CharacterPlan& after);

}  // namespace imomushi
