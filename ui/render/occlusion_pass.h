// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/pass.h"

namespace imomushi::render {

/// Normals and depths of what is seen, and from them ambient occlusion and the visibility of the key light, in screen space.
class OcclusionPass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// False: the driver has no memory for it.
    bool resize(int width, int height, bool software);
    void draw(const PassInput& in, GLuint shadowMap);
    void releaseMemory();

    /// See surface.frag.
    [[nodiscard]] GLuint surface() const { return surface_.color(); }
    /// See occlusion.frag.
    [[nodiscard]] GLuint occlusion() const { return occlusion_.color(); }

private:
    Program surfaceProgram_, occlusionProgram_, blurProgram_;
    FullscreenTriangle triangle_;
    Sampler shadowSampler_;
    Target surface_, noisy_, occlusion_;
};

}  // namespace imomushi::render
