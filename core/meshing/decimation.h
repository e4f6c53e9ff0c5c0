// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A body of fewer vertices in the place of another: closed, outward, manifold, free of self-intersections, of the same topology.
struct DecimatedBody {
    TriangleMesh mesh;
    /// The faces with the name, frame, area and size of the given ones and with vertices and triangles of `mesh`. All vertices of a face are
    /// vertices of the body's, and its rim runs along the same lines but for the tolerance, so that a flat face stays in its plane.
    std::vector<JointFace> faces;
    std::vector<std::int32_t> bodyVertex;  ///< of each vertex of `mesh`: the body vertex at exactly the same place, -1: it was moved
    double volumeError = 0.0;              ///< volume of `mesh` over that of the body, minus 1; 0 for a body without volume
};

/// Fewer than this times the wanted number of vertices are about as many.
constexpr double kAboutAsMany = 1.1;

/// Collapses edges, the least costly first, until `vertices` are left. The cost weighs length against distance from the body: for elasticity
/// flat parts need vertices too, so a decimated body has edges of about equal length, finer where the surface bends strongly and
/// towards rims that are finer. New vertices minimise the distance from the planes of all triangles that they stand for (Garland and
/// Heckbert 1997) and keep the volume (Lindstrom and Turk 1998). Vertices of a rim vanish only where it is
/// straight, or leaves the line between its neighbours by no more than `rimTolerance` (per face, none: 0) times the square root of the face's area.
/// `longest`: per body vertex, the wanted length of edges there (m), as far as it is less than elsewhere; around it, it grows with the distance. Empty: none.
/// `most`: more than so many times the wanted number are an error.
/// Deterministic, one thread.
/// Errors: "cancelled", "too-many-vertices" (the body has not so many), "too-few-vertices" (the message names the smallest number that can be
/// reached with these rims), "not-closed", "self-intersecting" (the body meets itself, so no smaller one is free of it), "bad-value".
Result<DecimatedBody> decimate(const TriangleMesh& body, std::span<const JointFace> faces, int vertices, const Progress& progress,
                               std::span<const double> rimTolerance = {}, std::span<const double> longest = {}, double most = kAboutAsMany);

}  // namespace imomushi
