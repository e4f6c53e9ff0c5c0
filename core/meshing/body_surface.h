// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/meshing/decimation.h"
#include "core/meshing/disc_mesh.h"
#include "core/meshing/solved_body.h"
#include "core/meshing/solver_mesh.h"

namespace imomushi {

/// A body as it is solved: with the outlines of discs, where it has any.
struct BodySurface {
    SolverMesh mesh;
    std::vector<JointFace> faces;  ///< of `mesh`
    DiscMesh discs;                ///< its mesh has gone to `mesh`
    const TriangleMesh& body;
    std::span<const JointFace> ofBody;

    BodySurface(const TriangleMesh& whole, std::span<const JointFace> bodyFaces);
    [[nodiscard]] const TriangleMesh& triangles() const { return mesh.mesh; }
};

/// The face of each triangle, -1: none.
std::vector<std::int32_t> facesOfTriangles(const SolverMesh& mesh);

/// The edges of no face's triangle that are at least `length` long (m).
std::vector<std::array<std::int32_t, 2>> longFreeEdges(const SolverMesh& mesh, double length);

/// `mesh` is the body's polyhedron.
SolvedBody asItIs(const TriangleMesh& body, std::span<const JointFace> faces, SolverMesh mesh);
/// The same, with discs.
SolvedBody onItself(SolverMesh mesh, const BodySurface& surface);

/// Edges of a decimated disc's outline, in radii, where strips follow and in drafts, which have none.
inline constexpr double kOutlineEdge = 0.4, kOutlineEdgeOfDraft = 0.2;
/// Of decimate(): dense rims and thin walls may keep as many vertices as they need.
constexpr double kAsFewAsRimsAllow = std::numeric_limits<double>::infinity();
/// A body of so many vertices in its place. `outlineEdge`: at outlines of discs, in their radii. `most` and errors: those of decimate().
Result<SolvedBody> onDecimated(const BodySurface& surface, int vertices, const Progress& progress, double outlineEdge = kOutlineEdge, double most = kAboutAsMany);

}  // namespace imomushi
