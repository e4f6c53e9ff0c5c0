// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/pass.h"

namespace imomushi::render {

/// Bodies, lit, and their highlighted triangles, into the multisampled linear picture that is bound.
class BodyPass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// Depth test on. Leaves blending on and culling off.
    void draw(const PassInput& in, GLuint occlusion) const;

private:
    void drawLit(const Body& body, const GpuBody& gpu) const;
    void drawHighlights(const PassInput& in) const;

    Program lit_, highlight_;
};

}  // namespace imomushi::render
