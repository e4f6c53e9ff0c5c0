// SPDX-License-Identifier: GPL-3.0-or-later
// Red: ambient occlusion from the depth of the picture (after McGuire et al. 2012, "Scalable Ambient Obscurance").
// Green: how much of the key light is visible. Both are smooth, so they may be computed at half the resolution.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
#include "disc_samples.glsl"
#include "surface.glsl"
in vec2 uv;
uniform sampler2D surface;
uniform sampler2DShadow shadowMap;
uniform float radius;  // m
uniform int taps;
out vec4 outOcclusion;

vec3 viewPosition(vec2 at, float depth) {
    vec2 slope = (at * 2.0 - 1.0) * frame.projection.xy;
    return vec3(frame.eye.w > 0.5 ? slope : slope * depth, -depth);
}

float keyVisible(vec3 p, vec3 n, float turn) {
    // Moving the point out along the normal keeps a surface from shadowing itself.
    vec3 q = (frame.shadow * vec4(p + n * frame.projection.z, 1.0)).xyz * 0.5 + 0.5;
    vec2 x = vec2(cos(turn), sin(turn)) * frame.keyDirection.w, y = vec2(-x.y, x.x);
    float sum = 0.0;
    for (int i = 0; i < kTaps; ++i) sum += texture(shadowMap, vec3(q.xy + kDiscSamples[i].x * x + kDiscSamples[i].y * y, q.z - 0.0007));
    return sum / float(kTaps);
}

void main() {
    vec2 here = texture(surface, uv).xy;
    outOcclusion = vec4(1.0);
    if (here.x > 1e20) return;
    vec3 p = viewPosition(uv, here.x);
    vec3 n = unpackedNormal(here.y);
    // The disc of `radius` around p on the screen, in texture coordinates.
    vec2 disc = radius / (2.0 * frame.projection.xy * (frame.eye.w > 0.5 ? 1.0 : here.x));
    disc = min(disc, vec2(0.15));
    float turn = pixelNoise(floor(gl_FragCoord.xy)) * 6.2831853;
    float sum = 0.0;
    for (int i = 0; i < taps; ++i) {
        float r = (float(i) + 0.5) / float(taps);
        float angle = turn + float(i) * 2.3999632;
        vec2 at = uv + r * vec2(cos(angle), sin(angle)) * disc;
        float depth = texture(surface, at).x;
        vec3 d = viewPosition(at, min(depth, 1e6)) - p;
        float dd = dot(d, d);
        float f = max(radius * radius - dd, 0.0) / (radius * radius);
        sum += f * f * max((dot(d, n) - 0.02 * radius) * inversesqrt(dd + 1e-4 * radius * radius), 0.0);
    }
    mat3 toWorld = transpose(mat3(frame.view));
    vec3 world = toWorld * (p - frame.view[3].xyz);
    outOcclusion = vec4(clamp(1.0 - 2.1 * sum / float(taps), 0.0, 1.0), keyVisible(world, toWorld * n, turn), 0.0, 1.0);
}
