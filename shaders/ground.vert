// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
#include "frame.glsl"
uniform vec2 middle;  // x, z
out vec3 worldPosition;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec2 at = middle + corner * frame.lines.w;
    worldPosition = vec3(at.x, frame.ground.x, at.y);
    gl_Position = frame.viewProjection * vec4(worldPosition, 1.0);
}
