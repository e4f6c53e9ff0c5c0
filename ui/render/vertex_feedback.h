// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "ui/render/gl.h"

// Passes of points without a picture, whose results transform feedback keeps in a buffer: what the two stages of GpuDeformer share.
namespace imomushi::render {

/// A buffer filled with `data`, left bound to `target`.
template <class T>
Buffer makeBuffer(GLenum target, const std::vector<T>& data, GLenum usage = GL_STATIC_DRAW) {
    Buffer buffer = makeBuffer();
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), usage);
    return buffer;
}

/// A buffer as a shader reads it by texel; `format`: of a texel.
TextureName makeBufferTexture(GLenum format, const Buffer& buffer);
void bindBufferTexture(int unit, GLuint texture);

/// Runs the vertex shader once per point; program, vertex array and textures are bound. Writes `bytes` of `buffer` from `offset` on.
void runVertexFeedback(int count, GLuint buffer, std::size_t offset, std::size_t bytes);

/// Puts what such passes bind back to OpenGL's defaults.
void unbindVertexFeedback();

}  // namespace imomushi::render
