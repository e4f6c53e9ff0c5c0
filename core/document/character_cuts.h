// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/document/document.h"

// Cuts of characters, as changes of a document. Elements keep their ids, names, bones and joint faces as far as a cut leaves these whole; elements beside which no cut
// changed stay the same objects, so that their responses stay fresh.
//
// Errors of all: those of cutBody() with the names of the cuts, "face-cut" (a joint face would be cut or touched), "cut-passes" (a cut would come to lie on the other
// side of another one), "no-patch" and others of joint faces.

namespace imomushi {

/// The whole body of a character as an element, without an id and a name.
Element wholeElement(const CharacterSource& character);

/// What a cut has made.
struct MadeCut {
    PartId character = 0, cut = 0;
    std::array<PartId, 2> elements{};      ///< behind the plane, in front of it
    std::array<std::string, 2> faces;      ///< of the two elements, joined
    double smallestAngle = 0.0;            ///< of the triangles of its caps, radians
};
/// Makes an element a whole character, which has its mesh as render mesh and as body and no cut yet. Returns the id of the character.
PartId makeCharacter(Document& document, PartId element, const std::string& name);

/// Cuts the body of a character. The piece behind the plane stays the element that it is cut from, called `names[0]` (empty: as before); the piece in front becomes a new
/// element `names[1]` (empty: named after the other). Bones that lie wholly in front run through that one from then on. `cut`: without an id; without a name it gets one. `element`: the one that is meant; 0: whichever the plane cuts.
/// More errors: "other-element" (the section nearest to the origin belongs to another element than `element`).
Result<MadeCut> addCut(Document& document, PartId character, PartId element, Cut cut, const std::array<std::string, 2>& names, const Progress& progress);

/// Gives a character another body, which its cuts divide as they did the old one. Joint faces stay where their triangles do, those of cuts are the new caps, handles are
/// discs of the new surface. Returns the elements that changed. More errors: "face-lost" (another joint face lies on what changed).
Result<std::vector<PartId>> changeBody(Document& document, PartId character, std::shared_ptr<const Body> body, const Progress& progress);

/// Gives a cut another plane, turned such that the same elements lie in front of it. Bones at its joint faces follow them. Returns the elements that changed, two or none.
Result<std::vector<PartId>> moveCut(Document& document, PartId character, PartId cut, const CutPlane& plane, const Progress& progress);

/// Takes a cut out: the element behind it takes in the one in front, with its joint faces and the bones through it. Returns the element that changed.
Result<PartId> removeCut(Document& document, PartId character, PartId cut, const Progress& progress);

}  // namespace imomushi
