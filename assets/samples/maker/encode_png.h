// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace imomushi::samples {

/// A PNG file of `rgb`: 3 bytes per pixel, rows from the top. Throws where libpng fails.
std::vector<unsigned char> encodePng(const std::vector<unsigned char>& rgb, int width, int height);

}  // namespace imomushi::samples
