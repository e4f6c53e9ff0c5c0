// SPDX-License-Identifier: GPL-3.0-or-later
// Highlighted triangles (being chosen, or the places of an issue): a tint with a fine chequer, so that it shows on any colour and without colour.
#version 330 core
#include "frame.glsl"
uniform vec3 tint;
out vec4 outColor;

void main() {
    vec2 cell = floor(gl_FragCoord.xy / (3.0 * frame.forward.w));
    float chequer = mod(cell.x + cell.y, 2.0);
    outColor = vec4(tint, 1.0) * mix(0.42, 0.66, chequer);
}
