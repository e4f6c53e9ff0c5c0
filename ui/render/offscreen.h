// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/result.h"
#include "ui/render/scene.h"

namespace imomushi::render {

/// An OpenGL context without window or display (EGL surfaceless), current from creation to destruction on its thread. While it lives
/// floating-point traps are off on that thread: drivers compute with infinities on purpose.
class OffscreenContext {
public:
    /// Errors: "no-opengl" with what EGL said.
    static Result<std::unique_ptr<OffscreenContext>> create();
    virtual ~OffscreenContext() = default;
};

/// Largest pictures that are drawn: side and number of pixels (8192 x 4320 and the like).
inline constexpr int kLargestSide = 8192;
inline constexpr long kMaxPixels = 36'000'000;

/// Draws scenes one after the other without a display, and keeps on the graphics card what did not change between them. Works beside any other context of
/// the caller: one thread of the process with a context of its own draws for all views. Buffers are kept for the view that drew last; a picture
/// never depends on those of other views.
class OffscreenView {
public:
    OffscreenView() = default;
    ~OffscreenView();
    OffscreenView(const OffscreenView&) = delete;
    OffscreenView& operator=(const OffscreenView&) = delete;

    /// RGBA rows from the top, 4 bytes a pixel, sRGB with straight alpha. Errors: "no-opengl", "bad-shader", "bad-size", "out-of-memory".
    Result<std::vector<std::uint8_t>> draw(const Scene& scene, int width, int height);

private:
    bool drew_ = false;
};

/// A single picture, as by OffscreenView::draw().
Result<std::vector<std::uint8_t>> drawOffscreen(const Scene& scene, int width, int height);

}  // namespace imomushi::render
