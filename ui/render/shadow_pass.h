// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "ui/render/pass.h"

namespace imomushi::render {

/// The shadow map of the key light, and the shade of the ground around the bodies. Both depend on geometry only: they stay while nothing but the camera moves.
class ShadowPass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// False: the driver has no memory for it.
    bool resize(bool software);
    void draw(const PassInput& in);
    void releaseMemory();

    [[nodiscard]] GLuint shadowMap() const { return shadowMap_.depth(); }
    /// See ground_shadow.frag.
    [[nodiscard]] GLuint groundShade() const { return shade_.color(); }

private:
    bool changed(const PassInput& in);

    Program depth_, height_, groundShadow_, blur_;
    FullscreenTriangle triangle_;
    Sampler rawDepth_;
    Target shadowMap_, shade_, blurred_;
    std::uint64_t drawnKey_ = 0;
};

}  // namespace imomushi::render
