// SPDX-License-Identifier: GPL-3.0-or-later
// The outline around what is selected (red of the mask) or under the pointer (green): as wide everywhere, on the outside.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
uniform sampler2D mask;
uniform vec3 selectedColor;  // linear
uniform vec3 hoveredColor;
out vec4 outColor;

const int kRing = 16;
void main() {
    vec2 here = texture(mask, gl_FragCoord.xy * frame.viewport.zw).rg;
    vec2 wide = vec2(0.0), thin = vec2(0.0);
    for (int i = 0; i < kRing; ++i) {
        float angle = 6.2831853 * float(i) / float(kRing);
        vec2 d = vec2(cos(angle), sin(angle)) * frame.forward.w * frame.viewport.zw;
        wide = max(wide, texture(mask, gl_FragCoord.xy * frame.viewport.zw + d * 2.2).rg);
        thin = max(thin, texture(mask, gl_FragCoord.xy * frame.viewport.zw + d * 1.0).rg);
    }
    float selected = max(wide.r, thin.r) * (1.0 - here.r);
    float hovered = max(thin.g, 0.0) * (1.0 - here.g) * (1.0 - selected);
    vec3 color = selectedColor * selected + hoveredColor * hovered * 0.9;
    float alpha = selected + hovered * 0.9;
    if (alpha < 0.002) discard;
    outColor = vec4(encodeSrgb(color / alpha) * alpha, alpha);
}
