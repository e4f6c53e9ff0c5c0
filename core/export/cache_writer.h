// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/export/motion.h"

namespace imomushi {

/// Writes the positions of all vertices in each frame, single precision, m: those of the bodies of elements, one after the other; or of a mesh of the scene in the order of its
/// file, so that a cache can be put on the artist's own object:
///   .pc2, .mdd  point caches, with the mesh at rest beside them as .obj: the object that a cache is put on
///   .obj, .ply  a file per frame, numbered from 0001 before the suffix
/// Several clips have a cache each: for a.pc2 and the clip "walk" a_walk.pc2; for a.obj the folder a_walk with a_0001.obj and so on. Where a scene has more than one mesh, or
/// one and other elements, each mesh has files of its own, as if the path were a_NAME.pc2. Meshes go out as .obj with all that obj_model.h says. Frames of PC2 are evenly spaced. Reads some of it back. Fills files, bytes, written, vertices, triangles, keys, check, checked and warnings of `report`.
/// Errors: "unknown-format", "not-writable", "not-readable", "cancelled".
Result<void> writeCache(Motion& motion, const ExportScene& scene, const std::filesystem::path& path, ExportReport& report, const Progress& progress);

}  // namespace imomushi
