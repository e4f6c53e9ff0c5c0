// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace imomushi {

/// How many earlier versions a project file keeps. Beyond either limit the oldest are deleted. See project_versions.h.
struct VersionLimits {
    int count = 10;
    std::uintmax_t bytes = std::uintmax_t{4} << 30;  ///< of all versions of a project together; 0: none are kept
};

}  // namespace imomushi
