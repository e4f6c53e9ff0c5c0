// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "core/document/command.h"
#include "core/mesh/mesh.h"

// What "copy" says and "paste" reads, beside the commands themselves.

namespace imomushi {

/// The key of a copied command that says where its parts were: {"from", "to"} of a bone; {"body", "at"} of a handle; {"body", "plane"} of a joint face.
inline constexpr const char* kPasteHint = "was";

/// Which bodies have the same triangles, wherever they stand: 32 hexadecimal digits.
std::string shapeOfBody(const TriangleMesh& body);

/// The point of the surface that is nearest, as [triangle, a, b, c] with weights of its corners; and where that is on a body. None: there is no such place.
std::optional<Json> corners(const TriangleMesh& body, const Vec3& point);
std::optional<Vec3> pointAtCorners(const TriangleMesh& body, const Json& corners);

}  // namespace imomushi
