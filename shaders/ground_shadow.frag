// SPDX-License-Identifier: GPL-3.0-or-later
// Shade of the ground around the character: red as in height.frag, green the shadow of the key light, softer the higher what casts it.
#version 330 core
#include "frame.glsl"
#include "disc_samples.glsl"
in vec2 uv;
uniform sampler2D heightMap;
uniform sampler2D shadowDepth;  // compared here, not by the sampler
out vec4 outShade;

void main() {
    vec2 ground = frame.patchArea.xy + (uv * 2.0 - 1.0) * frame.patchArea.z;
    vec3 q = (frame.shadow * vec4(ground.x, frame.ground.x, ground.y, 1.0)).xyz * 0.5 + 0.5;
    q.z = min(q.z, 1.0);
    float search = 0.03, blockers = 0.0, depth = 0.0;
    for (int i = 0; i < kTaps; ++i) {
        float d = texture(shadowDepth, q.xy + kDiscSamples[i] * search).r;
        if (d < q.z - 0.002) {
            blockers += 1.0;
            depth += d;
        }
    }
    float shade = 0.0;
    if (blockers > 0.5) {
        float penumbra = clamp((q.z - depth / blockers) * 0.12, 0.004, 0.05);
        for (int i = 0; i < kTaps; ++i) {
            vec2 at = q.xy + kDiscSamples[i] * penumbra;
            shade += texture(shadowDepth, at).r < q.z - 0.002 ? 1.0 : 0.0;
        }
        shade /= float(kTaps);
    }
    outShade = vec4(texture(heightMap, uv).r, shade, 0.0, 1.0);
}
