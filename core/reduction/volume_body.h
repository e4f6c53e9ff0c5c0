// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/joints/joint_face.h"
#include "core/reduction/body_surface.h"
#include "core/reduction/solved_body.h"
#include "core/reduction/solver_mesh_setting.h"

namespace imomushi {

/// The body, or one of `vertices` vertices in its place, with smaller triangles at the rims of faces, filled with tetrahedra that grow from there.
/// Errors: "cancelled", "no-filling".
Result<SolvedBody> volumeBody(const BodySurface& surface, int vertices, const Progress& progress);

/// The vertices of the body that a setting fills with tetrahedra; 0: it is solved by boundary elements. `all`: see Tetrahedra::All.
int volumeVertices(std::span<const JointFace> faces, const SolverMeshSetting& setting, bool all);
/// About the nodes of a body that is filled from so many vertices.
int volumeNodes(int vertices);
/// Vertices of the coarser level that the error is estimated from.
int coarserVolumeVertices(int vertices);

}  // namespace imomushi
