// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "core/io/character_file.h"
#include "core/io/import.h"

namespace imomushi {

/// What a worker may use. An STL of 1.7 million triangles needs 0.9 GB and 15 s.
struct ImportLimits {
    std::size_t fileBytes = std::size_t{1} << 30;
    std::size_t memoryBytes = std::size_t{8} << 30;  ///< address space
    int cpuSeconds = 240;
    double wallSeconds = 600.0;
};

/// importFile() with other limits.
Result<ImportResult> importFile(const ImportRequest& request, const Progress& progress, const ImportLimits& limits);
/// importCharacter() with other limits.
Result<CharacterFile> importCharacter(const ImportRequest& request, const Progress& progress, const ImportLimits& limits);

}  // namespace imomushi
