// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/io/character_file.h"
#include "core/io/import.h"
#include "core/io/raw_scene.h"

namespace imomushi {

/// Reads the bytes of a file in this process (as importFile() and importCharacter() do in a worker) by the reader of its suffix.
/// Errors: as importFile().
Result<RawScene> readScene(const SourceFile& file, SceneUse use = SceneUse::Elements);

/// Unit, axes and mending: what importFile() answers for a scene. Errors: "non-finite", "too-far", "empty-mesh".
Result<ImportResult> buildResult(RawScene scene, const ImportRequest& request, const Progress& progress);

/// Unit and axes: what importCharacter() answers for a scene. Errors: "non-finite", "too-far", "empty-mesh".
Result<CharacterFile> buildCharacter(RawScene scene, const ImportRequest& request, const Progress& progress);

}  // namespace imomushi
