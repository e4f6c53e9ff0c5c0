// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
#include "frame.glsl"
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;  // linear, straight alpha
out vec3 worldPosition;
out vec3 worldNormal;
out vec4 solidColor;
layout(location = 3) in float behind;  // how visible it stays behind bodies
flat out float hidden;
out float depth;
void main() {
    worldPosition = position;
    worldNormal = normal;
    solidColor = color;
    hidden = behind;
    depth = -(frame.view * vec4(position, 1.0)).z;
    gl_Position = frame.viewProjection * vec4(position, 1.0);
}
