// SPDX-License-Identifier: GPL-3.0-or-later
// How much a body seen from below closes the ground: 1 where it touches, 0 at the height of the patch.
#version 330 core
#include "frame.glsl"
in vec3 worldPosition;
out vec4 outShade;

void main() {
    float h = clamp((worldPosition.y - frame.ground.x) / frame.patchArea.w, 0.0, 1.0);
    outShade = vec4((1.0 - h) * (1.0 - h), 0.0, 0.0, 1.0);
}
