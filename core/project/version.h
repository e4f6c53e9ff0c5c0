// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// Of the program; CMakeLists.txt reads it here.
inline constexpr const char* kVersion = "0.1.0";

}  // namespace imomushi
