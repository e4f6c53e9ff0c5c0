// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "ui/render/body_store.h"
#include "ui/render/frame.h"
#include "ui/render/gl.h"
#include "ui/render/scene.h"

namespace imomushi::render {

/// The picture that is being drawn, as every pass reads it.
struct PassInput {
    const Scene& scene;
    const Frame& frame;
    const std::vector<GpuBody*>& bodies;  ///< of scene.bodies; null: nothing to draw
    int width, height;                    ///< device pixels
    bool software;                        ///< OpenGL on the processor: cheaper shadows and occlusion
    int samples;                          ///< per pixel of pictures whose edges are smoothed
};

/// All triangles of a body, with the program that is in use.
inline void drawTriangles(const GpuBody& body) {
    glBindVertexArray(body.vertexArray);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(body.geometry->indices().size()), GL_UNSIGNED_INT, nullptr);
}

/// Closed bodies face outward, so what faces away is hidden.
inline void cullBackFaces(bool on) { (on ? glEnable : glDisable)(GL_CULL_FACE); }

/// Limits drawing into `target` to the part of the picture that bodies and markers cover: most of it is background.
void scissorToContent(const Frame& frame, const Target& target);

}  // namespace imomushi::render
