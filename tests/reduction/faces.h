// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/joints/joint_face.h"
#include "tests/support/shapes.h"

namespace imomushi {

/// The ends of a body as joint faces.
inline std::vector<JointFace> facesOf(const shapes::Body& body) {
    std::vector<JointFace> faces;
    for (const auto& end : body.ends) faces.push_back(jointFaceByVertices(body.mesh, end.vertices).value());
    return faces;
}

}  // namespace imomushi
