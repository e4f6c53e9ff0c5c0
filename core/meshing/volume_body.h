// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/meshing/body_surface.h"
#include "core/meshing/solved_body.h"
#include "core/meshing/solver_mesh_setting.h"

namespace imomushi {

/// The body, or one of `detail.vertices` vertices in its place, with smaller triangles at the rims of faces, filled with tetrahedra that grow from there.
/// Errors: "cancelled", "no-filling" (also where its surface would have more than `mostVertices` before edges at rims are made), and the others of fillWithTetrahedra(), which say nothing about the body.
Result<SolvedBody> volumeBody(const BodySurface& surface, const VolumeDetail& detail, const Progress& progress, int mostVertices = std::numeric_limits<int>::max());

/// How finely a setting fills a body with tetrahedra; no vertices: it is solved by boundary elements.
VolumeDetail volumeDetail(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting);
/// About the nodes of a body that is filled so.
int volumeNodes(const TriangleMesh& body, std::span<const JointFace> faces, const VolumeDetail& detail);
/// The coarser level that the error is estimated from; `decimated`: the finer one is.
VolumeDetail coarserVolume(const VolumeDetail& detail, bool decimated);
/// CoarserLevel::share of it.
double volumeErrorLeft(const SolvedBody& fine);

}  // namespace imomushi
