// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/document/document.h"

// Joint faces as joints, bones and cuts refer to them.

namespace imomushi {

/// Faces farther apart than this, relative to their size, are not joined: the seam would show.
inline constexpr double kLargestGap = 0.01;
/// How far two faces are apart at most: m, and relative to the larger one.
struct FaceGap {
    double gap = 0.0, share = 0.0;
};
FaceGap faceGap(const Document& document, const FaceRef& a, const FaceRef& b);

/// Joins two faces; a joint that one of them has takes in the other. Errors: "is-handle", "same-element", "gap-too-large", "already-joined".
struct JoinedFaces {
    std::size_t welded = 0;  ///< pairs of vertices that are one point
    double gap = 0.0;        ///< m
};
Result<JoinedFaces> joinFaces(Document& document, const FaceRef& a, const FaceRef& b);

/// Whether the patch of a face may become another one. Errors: "face-fixed" (it is a handle, of a cut, or joined).
Result<void> checkFree(const Document& document, const FaceRef& face);

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
