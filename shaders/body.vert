// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
layout(location = 0) in vec3 position;  // world
layout(location = 1) in vec3 normal;    // world, unit
layout(location = 2) in vec2 texCoord;
layout(location = 3) in vec4 color;     // linear
uniform mat4 transform;                 // world -> clip space of this pass
out vec3 worldPosition;
out vec3 worldNormal;
out vec2 uv;
out vec4 vertexColor;

void main() {
    worldPosition = position;
    worldNormal = normal;
    uv = texCoord;
    vertexColor = color;
    gl_Position = transform * vec4(position, 1.0);
}
