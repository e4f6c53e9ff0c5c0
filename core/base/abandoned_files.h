// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace imomushi {

/// Removes what killed writers of any file left in `folder`: of AtomicFile alone, and nothing that a process still writes. For folders that are our own.
void removeAbandonedFiles(const std::filesystem::path& folder);

/// Those of one file.
void removeAbandonedPartsOf(const std::filesystem::path& file);

}  // namespace imomushi
