// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

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

/// What an artist is told of a surface of any kind.
struct SurfaceReport {
    std::vector<MeshIssue> found;  ///< on the surface as it is
    std::vector<MeshIssue> done;   ///< what the steps mended (fixed)
    std::vector<MeshIssue> left;   ///< after the steps
};

/// Looks at a surface as it is and after some steps of mending, which are done in the order of RepairAction; Wrap is none of them. Vertices at the same place are one
/// issue ("unwelded"), and other issues are those of the welded surface. No issue is more than a warning, since a body can be made around anything. Places are triangles
/// and vertices of `mesh`. `part`: #F, the part of each triangle, or empty: one part. Errors: "empty-mesh", "bad-index", "non-finite" (a vertex in use).
Result<SurfaceReport> examineSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part, std::span<const RepairAction> steps = {});

/// Gives issues without places those that `found` has for the same code.
void placeIssues(std::vector<MeshIssue>& issues, const std::vector<MeshIssue>& found);

}  // namespace imomushi
