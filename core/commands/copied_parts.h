// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>

#include "core/commands/part_copies.h"
#include "core/document/command.h"

// What the commands that copy parts of a document have in common.

namespace imomushi {

/// Parts that are to be copied; of characters all elements.
struct CopiedParts {
    std::set<PartId> characters, elements, bones;

    void addCharacter(const Document& document, PartId character);
    /// Or the whole character that it is a piece of.
    void addElement(const Document& document, const Element& element);
    /// The bones through the elements.
    void addBones(const Document& document);
};

/// Errors: "bad-value" (`key` would take parts too far away).
Result<void> checkPlaces(const Document& document, const CopiedParts& parts, const Placing& placing, const char* key);

/// How far copies of bones go along x to stand beside those within a box, m.
double besideBones(const Vec3& low, const Vec3& high);

/// The last responses of the elements, fresh ones and drafts.
std::function<const StoredResponse*(PartId)> lastResponses(const DocumentEdit& edit);

/// Copies of bones whose element was not copied run through the one around them.
void findElements(Document& document, const Document& from, const PartCopier& copier);

/// "elements", "characters", "cuts", "handles", "bones": [{"name", "from"}].
Json copiesJson(const PartCopier& copier);

}  // namespace imomushi
