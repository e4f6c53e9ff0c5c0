// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/vertex_feedback.h"

namespace imomushi::render {

namespace {
constexpr int kTextureUnits = 4;  // the most that a pass uses
}

TextureName makeBufferTexture(GLenum format, const Buffer& buffer) {
    GLuint n = 0;
    glGenTextures(1, &n);
    glBindTexture(GL_TEXTURE_BUFFER, n);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffer);
    glBindTexture(GL_TEXTURE_BUFFER, 0);
    return TextureName(n);
}

void bindBufferTexture(int unit, GLuint texture) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_BUFFER, texture);
}

void runVertexFeedback(int count, GLuint buffer, std::size_t offset, std::size_t bytes) {
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes));
    glEnable(GL_RASTERIZER_DISCARD);
    glBeginTransformFeedback(GL_POINTS);
    glDrawArrays(GL_POINTS, 0, count);
    glEndTransformFeedback();
    glDisable(GL_RASTERIZER_DISCARD);
}

void unbindVertexFeedback() {
    for (int unit = kTextureUnits - 1; unit >= 0; --unit) bindBufferTexture(unit, 0);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, 0);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glUseProgram(0);
}

}  // namespace imomushi::render
