// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/base/progress.h"
#include "core/io/import.h"
#include "core/io/raw_scene.h"

namespace imomushi {

/// Reads the bytes of a file in this process (the worker's part of importFile()) by the reader of its suffix.
/// Errors: as importFile().
Result<RawScene> readScene(const SourceFile& file);

/// Unit, axes and mending: what importFile() answers for a scene. Errors: "non-finite", "empty-mesh".
Result<ImportResult> buildResult(RawScene scene, const ImportRequest& request, const Progress& progress);

}  // namespace imomushi
