// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/pass.h"

namespace imomushi::render {

/// The outlines around selected and hovered bodies, over the finished picture.
class OutlinePass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// `target`: framebuffer object of the finished picture. Without memory for the masks there are no outlines.
    void draw(const PassInput& in, unsigned target);
    void releaseMemory();

private:
    Program mask_, outline_;
    FullscreenTriangle triangle_;
    Target samples_, resolved_;
};

}  // namespace imomushi::render
