// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ui/render/marker_geometry.h"
#include "ui/render/pass.h"

namespace imomushi::render {

/// Bones, handles, outlines and gizmos over the bodies, into the multisampled linear picture that is bound.
class MarkerPass {
public:
    /// Errors: "bad-shader".
    Result<void> prepare();
    /// `surface`: see surface.frag; where bodies are in front, markers are dimmer. Depth test and blending on; leaves the depth test off.
    void draw(const PassInput& in, GLuint surface);

private:
    Program solid_, line_, point_;
    VertexArray solidArray_, lineArray_, pointArray_;
    Buffer solidBuffer_, lineBuffer_, pointBuffer_;
    MarkerGeometry geometry_;
};

}  // namespace imomushi::render
