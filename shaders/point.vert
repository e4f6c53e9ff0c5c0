// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
#include "frame.glsl"
layout(location = 0) in vec3 centre;
layout(location = 1) in vec3 shape;   // radius in device pixels; 0 ring, 1 disc in a ring, 2 diamond, 3 square ring; how visible it stays behind bodies
layout(location = 2) in vec4 color;   // linear, straight alpha
out vec4 pointColor;
flat out vec3 pointShape;
noperspective out vec2 at;            // device pixels from the centre
out float depth;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec4 c = frame.viewProjection * vec4(centre, 1.0);
    at = corner * (shape.x + 3.0 * frame.forward.w);
    gl_Position = c + vec4(at * 2.0 * frame.viewport.zw * c.w, 0.0, 0.0);
    pointColor = color;
    pointShape = shape;
    depth = -(frame.view * vec4(centre, 1.0)).z;
}
