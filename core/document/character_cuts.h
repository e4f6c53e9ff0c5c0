// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
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

struct NewCut {
    Cut cut;                            ///< without an id; without a name it gets one
    std::array<std::string, 2> names{};  ///< of the pieces behind and in front of it; empty: as the element was, and named after it
};
struct MadeCuts {
    struct Refused {
        std::size_t cut;  ///< of those that were asked for
        Error why;
    };
    std::vector<std::optional<MadeCut>> made;  ///< per cut that was asked for
    std::vector<Refused> refused;              ///< those that were left out
};

/// Cuts the body of a character by all planes together. The piece of an element that lies behind all its new cuts keeps the element's id; each other piece becomes a new
/// element. A bone that lies wholly in one piece belongs to that piece. `element`: the one that is meant; 0: whichever the planes cut. `leaveOut`: a cut that is refused is
/// left out where others can be made. More errors: "other-element" (the section nearest to an origin belongs to another element than `element`).
Result<MadeCuts> addCuts(Document& document, PartId character, PartId element, std::vector<NewCut> cuts, bool leaveOut, const Progress& progress);

/// The same with one.
Result<MadeCut> addCut(Document& document, PartId character, PartId element, Cut cut, const std::array<std::string, 2>& names, const Progress& progress);

/// Gives a character another body, which its cuts divide as they did the old one. Joint faces stay where their triangles do, those of cuts are the new caps, handles are
/// discs of the new surface. Returns the elements that changed. More errors: "face-lost" (another joint face lies on what changed).
Result<std::vector<PartId>> changeBody(Document& document, PartId character, std::shared_ptr<const Body> body, const Progress& progress);

/// Gives a cut another plane, turned such that the same elements lie in front of it. Bones at its joint faces follow them. Returns the elements that changed, two or none.
Result<std::vector<PartId>> moveCut(Document& document, PartId character, PartId cut, const CutPlane& plane, const Progress& progress);

/// Takes a cut out: the element behind it takes in the one in front, with its joint faces and the bones through it. Returns the element that changed.
Result<PartId> removeCut(Document& document, PartId character, PartId cut, const Progress& progress);

}  // namespace imomushi
