// SPDX-License-Identifier: GPL-3.0-or-later
// View-space normal and distance in front of the eye, for ambient occlusion and for markers that fade behind bodies.
#version 330 core
#include "frame.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
out vec4 outSurface;

void main() {
    vec3 n = normalize(mat3(frame.view) * (gl_FrontFacing ? worldNormal : -worldNormal));
    outSurface = vec4(n, -(frame.view * vec4(worldPosition, 1.0)).z);
}
