// SPDX-License-Identifier: GPL-3.0-or-later
// Distance in front of the eye and normal, for ambient occlusion and for markers that fade behind bodies.
#version 330 core
#include "frame.glsl"
#include "surface.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
out vec2 outSurface;

void main() {
    vec3 n = normalize(mat3(frame.view) * (gl_FrontFacing ? worldNormal : -worldNormal));
    outSurface = vec2(-(frame.view * vec4(worldPosition, 1.0)).z, packedNormal(n));
}
