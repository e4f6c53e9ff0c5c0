// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/document/document.h"

// Joint faces as joints, bones and cuts refer to them.

namespace imomushi {

/// Takes a face out of its joint; a joint of one face is none.
void leaveJoint(Document& document, const FaceRef& face);

/// Ends of bones at faces that go away stay where they are, as points.
void freeBones(Document& document, const std::vector<FaceRef>& faces);

/// Joints, bones and goals of handles that named `from` name `to`.
void replaceFace(Document& document, const FaceRef& from, const FaceRef& to);

/// Takes an element out of the document with all that hangs on it: its faces leave their joints, bones that ended at them stay where they are, bones through it run through
/// `heir` (0: none), effects and fingers on it are gone.
void dropElement(Document& document, PartId element, PartId heir = 0);

}  // namespace imomushi
