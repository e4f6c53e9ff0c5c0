// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cstdlib>
#include <vector>

#include "ui/render/offscreen.h"

namespace imomushi {

/// A drawn picture.
struct Picture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;

    [[nodiscard]] std::array<int, 4> at(int x, int y) const {
        const std::uint8_t* p = &rgba[4 * (std::size_t(y) * width + x)];
        return {p[0], p[1], p[2], p[3]};
    }
    /// Brightness without colour: what a picture says to somebody who sees none.
    [[nodiscard]] int grey(int x, int y) const {
        const auto p = at(x, y);
        return (2126 * p[0] + 7152 * p[1] + 722 * p[2]) / 10000;
    }
};

/// Pixels of two pictures of one size that differ by more than `by` in any channel.
inline int differing(const Picture& a, const Picture& b, int by = 8) {
    int n = 0;
    for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
        int most = 0;
        for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(a.rgba[i + c] - b.rgba[i + c]));
        n += most > by;
    }
    return n;
}

inline Picture drawn(const render::Scene& scene, int width, int height) {
    auto pixels = render::drawOffscreen(scene, width, height);
    REQUIRE_MESSAGE(pixels.has_value(), (pixels ? "" : pixels.error().message));
    REQUIRE(pixels->size() == std::size_t(width) * height * 4);
    return {width, height, std::move(*pixels)};
}

}  // namespace imomushi
