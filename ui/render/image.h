// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi::render {

/// A decoded picture: RGBA rows from the top, 4 bytes a pixel.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
};

/// Decodes PNG or JPEG bytes, told apart by their first bytes. Errors: "bad-image" (neither, damaged, or larger than 8192 pixels a side).
Result<Image> decodeImage(const std::vector<std::uint8_t>& bytes);

/// Writes RGBA rows as a PNG file, whole or not at all. `path` is UTF-8. Errors: "not-writable", "disk-full".
Result<void> writePng(const std::string& path, const std::vector<std::uint8_t>& rgba, int width, int height);

}  // namespace imomushi::render
