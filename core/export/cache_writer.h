// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/export/motion.h"

namespace imomushi {

/// Writes the positions of all body vertices, elements one after the other, in each frame, single precision, m:
///   .pc2, .mdd  point caches, with the mesh at rest beside them as .obj: the object that a cache is put on
///   .obj, .ply  a file per frame, numbered from 0001 before the suffix
/// Several clips have a cache each: for a.pc2 and the clip "walk" a_walk.pc2; for a.obj the folder a_walk with a_0001.obj and so on. Frames of PC2 are evenly spaced. Reads some of it back. Fills files, bytes, vertices, triangles, keys, check, checked and warnings of `report`.
/// Errors: "unknown-format", "not-writable", "not-readable", "cancelled".
Result<void> writeCache(Motion& motion, const ExportScene& scene, const std::filesystem::path& path, ExportReport& report, const Progress& progress);

}  // namespace imomushi
