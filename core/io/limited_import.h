// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/io/character_file.h"
#include "core/io/import.h"
#include "core/worker/worker.h"

namespace imomushi {

/// importFile() and importCharacter() with other limits than theirs.
Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress, const WorkLimits& limits);
Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress, const WorkLimits& limits);

}  // namespace imomushi
