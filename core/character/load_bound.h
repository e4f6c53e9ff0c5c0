// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// Body loads deform no element by more than this part of its size, approached smoothly: they are linear, and more would fold it.
inline constexpr double kMostLoaded = 0.25;

}  // namespace imomushi
