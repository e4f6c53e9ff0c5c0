// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/joints/joint_face.h"

// Joint faces of bodies that are turned, mirrored or replaced.

namespace imomushi {

/// The frame of a face (FaceFrame) about `origin` (m), with the outward unit normal `z`.
FaceFrame faceFrame(const Vec3& origin, const Vec3& z);

/// A face of `was` on another body of about the same shape and place: the patch in its plane, as far as a flat face has one there, else the triangles whose middles are
/// nearest to it. Without a name. Errors: "face-lost" (nothing of about its size lies there), those of jointFaceByTriangles().
Result<JointFace> refoundFace(const TriangleMesh& was, const JointFace& face, const TriangleMesh& body);

}  // namespace imomushi
