// SPDX-License-Identifier: GPL-3.0-or-later
// Averages the noise of occlusion.frag away without crossing edges in depth.
#version 330 core
#include "frame.glsl"
in vec2 uv;
uniform sampler2D surface;
uniform sampler2D occlusion;
uniform vec2 texel;
uniform float spread;  // texels between the samples
out vec4 outOcclusion;

void main() {
    float depth = texture(surface, uv).x;
    outOcclusion = vec4(1.0);
    // Past a silhouette the nearest body's value continues, so that a pixel of the full picture never reads the bright outside.
    float range = 0.06 * frame.sphere.w;
    vec2 sum = vec2(0.0);
    float weights = 1e-4;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            vec2 at = uv + vec2(x, y) * texel * spread;
            float d = texture(surface, at).x;
            float w = d > 1e20 ? 0.0 : (depth > 1e20 ? 1.0 : max(1.0 - abs(d - depth) / range, 0.0));
            sum += w * texture(occlusion, at).rg;
            weights += w;
        }
    outOcclusion = vec4(weights > 0.01 ? sum / weights : vec2(1.0), 0.0, 1.0);
}
