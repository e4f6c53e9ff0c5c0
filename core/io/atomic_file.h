// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.h"

namespace imomushi {

/// Replaces the file at `path` by `bytes`, or leaves it as it was: writes a file beside it, flushes it to the disk and renames it.
/// Errors: "not-writable".
Result<void> writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace imomushi
