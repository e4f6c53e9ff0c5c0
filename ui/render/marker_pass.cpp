// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/marker_pass.h"

#include <cstddef>

namespace imomushi::render {

namespace {

template <class T>
void stream(const Buffer& buffer, const std::vector<T>& data) {
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), GL_STREAM_DRAW);
}

/// A vertex array and its only buffer, both left bound.
void begin(VertexArray& array, Buffer& buffer) {
    array = makeVertexArray();
    buffer = makeBuffer();
    glBindVertexArray(array);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
}

}  // namespace

Result<void> MarkerPass::prepare() {
    begin(solidArray_, solidBuffer_);
    floatAttribute(0, 3, sizeof(SolidVertex), offsetof(SolidVertex, position));
    floatAttribute(1, 3, sizeof(SolidVertex), offsetof(SolidVertex, normal));
    floatAttribute(2, 4, sizeof(SolidVertex), offsetof(SolidVertex, color));
    floatAttribute(3, 1, sizeof(SolidVertex), offsetof(SolidVertex, behind));

    begin(lineArray_, lineBuffer_);
    floatAttribute(0, 3, sizeof(LineSegment), offsetof(LineSegment, before), 1);
    floatAttribute(1, 3, sizeof(LineSegment), offsetof(LineSegment, from), 1);
    floatAttribute(2, 3, sizeof(LineSegment), offsetof(LineSegment, to), 1);
    floatAttribute(3, 3, sizeof(LineSegment), offsetof(LineSegment, after), 1);
    floatAttribute(4, 4, sizeof(LineSegment), offsetof(LineSegment, color), 1);
    floatAttribute(5, 3, sizeof(LineSegment), offsetof(LineSegment, widths), 1);

    begin(pointArray_, pointBuffer_);
    floatAttribute(0, 3, sizeof(PointSprite), offsetof(PointSprite, centre), 1);
    floatAttribute(1, 3, sizeof(PointSprite), offsetof(PointSprite, shape), 1);
    floatAttribute(2, 4, sizeof(PointSprite), offsetof(PointSprite, color), 1);
    glBindVertexArray(0);
    return linkAll({{&solid_, "solid.vert", "solid.frag"}, {&line_, "line.vert", "line.frag"}, {&point_, "point.vert", "point.frag"}});
}

void MarkerPass::draw(const PassInput& in, GLuint surface) {
    geometry_.build(in.scene, in.height);
    // Bodies dim markers through the surface map, so markers only sort among themselves.
    glClear(GL_DEPTH_BUFFER_BIT);
    bindTexture(0, surface);
    solid_.use();
    solid_.set("surface", 0);
    glBindVertexArray(solidArray_);
    if (!geometry_.bones.empty()) {
        stream(solidBuffer_, geometry_.bones);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(geometry_.bones.size()));
    }
    if (!geometry_.sheets.empty()) {
        stream(solidBuffer_, geometry_.sheets);
        glDepthMask(GL_FALSE);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(geometry_.sheets.size()));
        glDepthMask(GL_TRUE);
    }
    glDisable(GL_DEPTH_TEST);
    const auto drawQuads = [](const Program& program, const VertexArray& array, const Buffer& buffer, const auto& instances) {
        if (instances.empty()) return;
        stream(buffer, instances);
        program.use();
        program.set("surface", 0);
        glBindVertexArray(array);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances.size()));
    };
    drawQuads(line_, lineArray_, lineBuffer_, geometry_.lines);
    if (!geometry_.gizmo.empty()) {
        glClear(GL_DEPTH_BUFFER_BIT);
        glEnable(GL_DEPTH_TEST);
        solid_.use();
        glBindVertexArray(solidArray_);
        stream(solidBuffer_, geometry_.gizmo);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(geometry_.gizmo.size()));
        glDisable(GL_DEPTH_TEST);
    }
    drawQuads(point_, pointArray_, pointBuffer_, geometry_.points);
}

}  // namespace imomushi::render
