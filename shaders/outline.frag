// SPDX-License-Identifier: GPL-3.0-or-later
// The outline around what is selected (red of the mask) or under the pointer (green): as wide everywhere, on the outside.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
uniform sampler2D mask;
uniform vec3 selectedColor;  // linear
uniform vec3 hoveredColor;
out vec4 outColor;

const int kRing = 12;
void main() {
    vec2 at = gl_FragCoord.xy * frame.viewport.zw, wide = 2.0 * frame.forward.w * frame.viewport.zw;
    // Over two pixels: without a graphics card the mask of what moves has no smooth edge of its own.
    vec2 corner = 0.5 * frame.viewport.zw;
    vec2 here = 0.25 * (texture(mask, at + corner).rg + texture(mask, at - corner).rg + texture(mask, at + vec2(corner.x, -corner.y)).rg + texture(mask, at + vec2(-corner.x, corner.y)).rg);
    vec2 around = here;
    for (int i = 0; i < kRing; ++i) {
        float angle = 6.2831853 * (float(i) + 0.5) / float(kRing);
        around = max(around, texture(mask, at + vec2(cos(angle), sin(angle)) * wide).rg);
    }
    float selected = around.r * (1.0 - here.r);
    float hovered = around.g * (1.0 - here.g) * (1.0 - selected) * 0.75;
    float alpha = selected + hovered;
    vec3 color = (selectedColor * selected + hoveredColor * hovered) / max(alpha, 1e-4);
    outColor = vec4(encodeSrgb(color) * alpha, alpha);
}
