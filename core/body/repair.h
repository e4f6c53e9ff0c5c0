// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/health.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// One step of mending. Weld: vertices at the same place where that closes edges. Drop: triangles without area, copies of others, unused vertices. Separate: what meets in
/// edges of more than two triangles or in single vertices. Orient: neighbours alike, surfaces outward, cavities inward. Fill: holes. Wrap: a new surface around all.
enum class RepairAction { Weld, Drop, Separate, Orient, Fill, Wrap };

/// "weld", "drop", "separate", "orient", "fill", "wrap".
std::string_view nameOf(RepairAction action);
/// The action of a name; none of an unknown one.
std::optional<RepairAction> repairActionOf(std::string_view name);
/// What mends an issue (MeshIssue::code); none where nothing here does.
std::optional<RepairAction> repairFor(std::string_view issueCode);

struct Repaired {
    TriangleMesh mesh;
    std::vector<std::int32_t> part;        ///< #F; empty after a wrap, which is one part
    std::vector<MeshIssue> before, after;  ///< checkMesh() of both
    std::vector<MeshIssue> done;           ///< what the action did; empty: nothing
};

/// Does one action on a surface of any kind. `part`: #F, the part of each triangle, or empty: one part. Vertices keep their order and, but for a wrap, their places.
/// Triangles with the same vertex twice go with every action. Errors: "empty-mesh", "bad-index", "non-finite" (a vertex in use), "no-volume" (no triangle has an area,
/// or a wrap has none), "cancelled".
Result<Repaired> repairSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part, RepairAction action, const Progress& progress);

/// What an artist is told of a surface of any kind.
struct SurfaceReport {
    std::vector<MeshIssue> found;  ///< on the surface as it is
    std::vector<MeshIssue> done;   ///< what the steps mended (fixed)
    std::vector<MeshIssue> left;   ///< after the steps
};

/// Looks at a surface as it is and after some steps of mending, which are done in the order of RepairAction; Wrap is none of them. Vertices at the same place are one
/// issue ("unwelded"), and other issues are those of the welded surface. No issue is more than a warning, since a body can be made around anything. Places are triangles
/// and vertices of `mesh`. `mesh`, `part`: as for repairSurface(). Errors: as repairSurface(), without "no-volume".
Result<SurfaceReport> examineSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part, std::span<const RepairAction> steps = {});

/// Gives issues without places those that `found` has for the same code.
void placeIssues(std::vector<MeshIssue>& issues, const std::vector<MeshIssue>& found);

}  // namespace imomushi
