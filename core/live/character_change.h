// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/character_input.h"
#include "core/document/document_change.h"

namespace imomushi {

/// Whether the live character is made of other things than before. False: it goes on, with other numbers for its effects at most.
bool changesCharacter(const DocumentChange& change, const Document& after);

/// Brings targets and pose of a document along when its joint points have changed: another skeleton begins from its rest pose, pins at rest go where the rest
/// pose is now, and what held endpoints that are gone is let go. `was`: null where the document before had no plan. True: something pulls the rest pose away.
bool followSkeleton(Document& document, const CharacterPlan* was, const CharacterPlan& is);

}  // namespace imomushi
