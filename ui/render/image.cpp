// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/image.h"

#include <png.h>
#include <turbojpeg.h>

#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include "core/base/atomic_file.h"

namespace imomushi::render {

namespace {

// A quarter of a gigabyte decoded: more is a mistake or an attack.
constexpr int kLargestTexture = 8192;

Result<Image> decodePng(const std::vector<std::uint8_t>& bytes) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return fail("bad-image", std::string("The PNG picture is damaged: ") + png.message);
    if (png.width > kLargestTexture || png.height > kLargestTexture) {
        png_image_free(&png);
        return fail("bad-image", "The PNG picture is larger than 8192 pixels a side: make it smaller.");
    }
    png.format = PNG_FORMAT_RGBA;
    Image image{static_cast<int>(png.width), static_cast<int>(png.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
    if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr)) return fail("bad-image", std::string("The PNG picture is damaged: ") + png.message);
    return image;
}

Result<Image> decodeJpeg(const std::vector<std::uint8_t>& bytes) {
    const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
    int width = 0, height = 0, sampling = 0, space = 0;
    if (!decoder || tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &sampling, &space) != 0)
        return fail("bad-image", "The JPEG picture is damaged.");
    if (width < 1 || height < 1 || width > kLargestTexture || height > kLargestTexture)
        return fail("bad-image", "The JPEG picture is larger than 8192 pixels a side: make it smaller.");
    Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 4)};
    if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), image.rgba.data(), width, 0, height, TJPF_RGBA, 0) != 0 &&
        tjGetErrorCode(decoder.get()) == TJERR_FATAL)
        return fail("bad-image", std::string("The JPEG picture is damaged: ") + tjGetErrorStr2(decoder.get()));
    return image;
}

}  // namespace

Result<Image> decodeImage(const std::vector<std::uint8_t>& bytes) {
    if (bytes.size() > 8 && std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0) return decodePng(bytes);
    if (bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff) return decodeJpeg(bytes);
    return fail("bad-image", "The picture is neither PNG nor JPEG: convert it to one of them.");
}

Result<void> writePng(const std::string& path, const std::vector<std::uint8_t>& rgba, int width, int height) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(width);
    png.height = static_cast<png_uint_32>(height);
    png.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::string bytes(size, '\0');
    if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, rgba.data(), 0, nullptr)) throw std::bad_alloc();  // nothing else can go wrong
    return writeFileAtomically(std::u8string(path.begin(), path.end()), std::string_view(bytes).substr(0, size));
}

}  // namespace imomushi::render
