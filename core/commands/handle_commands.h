// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// The face of a handle: the disc about the place of the surface nearest to `point`. Errors: those of jointFaceByDisc(), "bad-point" (too far from the surface), "shared-rim" (it
/// overlaps another face), "no-free-vertex".
Result<JointFace> handleFace(const Element& element, const Vec3& point, double radius, std::string_view instead = {});

/// Radii as parts of the diagonal of the element: unless one is given, and the largest.
inline constexpr double kDefaultHandleRadius = 0.05, kLargestHandleRadius = 0.5;

/// Forgets a handle of a face that goes; the face stays.
void eraseHandle(Document& document, const FaceRef& face);
/// A face that is a handle gets another name.
void renameHandle(Document& document, const FaceRef& face, const std::string& name);
/// Handles carried by a bone that is removed are carried by their elements from then on.
void releaseHandlesOf(Document& document, PartId bone);

/// "radius", "point" or "bone" of a handle. Errors: "no-such-property", "bad-value", those of handleFace().
Result<void> setHandleProperty(Document& document, const FaceRef& handle, const std::string& property, const Json& value);

// What drag, pin, unpin and release do with a handle.
Result<Json> dragHandle(DocumentEdit& edit, const FaceRef& handle, const Json& arguments);
Result<Json> showHandle(LiveCharacter& live, const FaceRef& handle);
Result<Json> pinHandle(DocumentEdit& edit, const FaceRef& handle);
Result<Json> unpinHandle(DocumentEdit& edit, const FaceRef& handle);
/// False: it is not held.
Result<bool> releaseHandle(DocumentEdit& edit, const FaceRef& handle);
/// Handles to where they are at rest, pins among them stay pins.
void restHandles(Document& document);

/// Of a handle that was moved, for "list".
Json heldHandleJson(const FaceRef& handle, const HandleGoal& goal);
Json handleJson(const Document& document, const Element& element, const Handle& handle);

}  // namespace imomushi
