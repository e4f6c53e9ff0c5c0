// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "ui/models/studio_document.h"

namespace imomushi {

/// What is selected, in a document; null where it is gone.
const Element* elementOf(const Document& document, const SelectionItem& item);  ///< of Element and Face
const Bone* boneOf(const Document& document, const SelectionItem& item);        ///< of Bone and Endpoint

/// The character that is selected, or whose cut is; and that cut.
const CharacterSource* characterOf(const Document& document, const SelectionItem& item);
const Cut* cutOf(const Document& document, const SelectionItem& item);

/// How commands call a thing: "bone/start", "element/face", or its own name; empty where it is gone.
std::string pathOf(const Document& document, const EndpointRef& end);
std::string pathOf(const Document& document, const FaceRef& face);
std::string pathOf(const Document& document, const SelectionItem& item);

/// Whether the viewport shows a part, and may pick and change it: elements, joint faces, bones, cuts.
struct Shown {
    bool visible = false, locked = false;
    [[nodiscard]] bool picked() const { return visible && !locked; }
};
template <class Part>
Shown shown(const Part& part) {
    return {part.visible, part.locked};
}
/// Of what is selected, an end as its bone; of what is gone and of whole characters nothing is seen.
Shown shownOf(const Document& document, const SelectionItem& item);

/// The handle that is selected; null: it is none.
const Handle* handleOf(const Document& document, const SelectionItem& item);

/// The endpoint is held where the artist pinned it.
bool isPinned(const Document& document, const EndpointRef& end);
bool isPinned(const Document& document, const FaceRef& handle);

}  // namespace imomushi
