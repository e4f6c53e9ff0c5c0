// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode_png.h"

#include <png.h>

#include <stdexcept>

namespace imomushi::samples {

std::vector<unsigned char> encodePng(const std::vector<unsigned char>& rgb, int width, int height) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width);
    image.height = png_uint_32(height);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t bytes = 0;
    if (!png_image_write_to_memory(&image, nullptr, &bytes, 0, rgb.data(), 0, nullptr)) throw std::runtime_error("PNG failed.");
    std::vector<unsigned char> png(bytes);
    if (!png_image_write_to_memory(&image, png.data(), &bytes, 0, rgb.data(), 0, nullptr)) throw std::runtime_error("PNG failed.");
    png.resize(bytes);
    return png;
}

}  // namespace imomushi::samples
