// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace imomushi {

/// Makes an .fbx file of a .glb file by a headless Blender (3.4 or younger): no free library writes FBX that other programs take. Each animation becomes a
/// stack of its name. The file is read back by Blender; the answer is the farthest that it has a vertex from where the .glb file has it, in m, over ten frames of
/// each.
/// Errors: "needs-blender" (it is not installed), "not-converted" (it failed; with its reason), "not-writable", "cancelled".
Result<double> convertToFbx(const std::filesystem::path& glb, const std::filesystem::path& fbx, double fps, const Progress& progress);

}  // namespace imomushi
