// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Vertices of two faces closer than this, relative to the larger face, are one point.
inline constexpr double kWeldDistance = 1e-6;

/// A joint face on its body.
struct FaceOnBody {
    const TriangleMesh* body = nullptr;
    const JointFace* face = nullptr;
};

/// Pairs (body vertex of a, body vertex of b) that are one point at rest; each vertex in at most one pair. By vertices of a, ascending.
std::vector<std::pair<std::int32_t, std::int32_t>> weldedVertices(const FaceOnBody& a, const FaceOnBody& b);

/// A vertex of one face and the point of the other face that lies nearest at rest.
struct SeamPoint {
    bool ofFirst = true;                ///< the vertex belongs to face a, the triangle to face b
    std::int32_t vertex = -1;
    std::int32_t triangle = -1;         ///< body triangle of the other face
    Vec3 weights = Vec3::Zero();        ///< barycentric
    double distance = 0.0;              ///< m at rest
    bool beside = false;                ///< the vertex hangs over the other face's outline: nothing lies opposite to it
};
std::vector<SeamPoint> seamPoints(const FaceOnBody& a, const FaceOnBody& b);

/// Largest distance of points that lie opposite to each other, when the bodies' vertices are at `a` and `b`, m.
double seamGap(const std::vector<SeamPoint>& seam, const TriangleMesh& bodyA, const Points& a, const TriangleMesh& bodyB, const Points& b);

/// Largest angle (radians) between the visible surfaces of two bodies where the rims of their joined faces meet; the faces themselves, which
/// lie inside, do not count. `a`, `b`: positions of the bodies' vertices.
double seamCrease(const FaceOnBody& faceA, const Points& a, const FaceOnBody& faceB, const Points& b);

}  // namespace imomushi
