// SPDX-License-Identifier: GPL-3.0-or-later
// The studio floor: a pool of light, soft shadows, and lines whose width is constant on the screen and that fade before they flicker.
#version 330 core
#include "frame.glsl"
in vec3 worldPosition;
uniform vec2 middle;
uniform sampler2D shade;
out vec4 outColor;

// Coverage of lines every `spacing` metres, `width` pixels wide; what is too dense becomes its own average.
vec2 gridLines(vec2 p, vec2 perPixel, float spacing, float width) {
    vec2 d = perPixel / spacing;
    vec2 halfWidth = clamp(0.5 * width * d, 0.0, 0.5);
    vec2 off = 0.5 - abs(fract(p / spacing) - 0.5);
    vec2 lines = clamp((halfWidth + 0.75 * d - off) / (1.5 * d), 0.0, 1.0);
    return mix(lines, 2.0 * halfWidth, smoothstep(0.25, 0.6, d));
}

float axisLine(float p, float perPixel, float width) {
    return 1.0 - smoothstep(0.5 * width - 0.6, 0.5 * width + 0.6, abs(p) / perPixel);
}

vec4 over(vec4 top, vec4 below) { return top + below * (1.0 - top.a); }

void main() {
    vec2 p = worldPosition.xz;
    bool dark = frame.ground.w > 0.5;
    bool above = frame.eye.w > 0.5 ? frame.forward.y < 0.0 : frame.eye.y > frame.ground.x;
    float away = length(p - middle) / frame.lines.w;
    float fade = 1.0 - smoothstep(0.12, 1.0, away);
    fade *= fade;
    vec3 v = towardsEye(worldPosition);
    float grazing = smoothstep(0.0, 0.18, abs(v.y));
    outColor = vec4(0.0);

    if (above) {
        // The pool of light under the character, only where there is a background to lighten.
        vec2 q = (p - frame.sphere.xz) / (2.4 * frame.sphere.w);
        float pool = exp(-dot(q, q)) * grazing * frame.ground.y;
        outColor = vec4(dark ? vec3(0.115, 0.125, 0.150) : vec3(0.97, 0.975, 0.985), 1.0) * pool * (dark ? 0.55 : 0.6);
    }
    if (frame.ground.y > 0.5) {
        vec2 perPixel = max(fwidth(p), vec2(1e-7));
        float width = frame.forward.w;
        float next = frame.lines.z;
        vec2 minor = gridLines(p, perPixel, frame.lines.x, width) * 0.42 * (1.0 - next);
        vec2 middling = gridLines(p, perPixel, frame.lines.y, width) * mix(1.0, 0.42, next);
        vec2 major = gridLines(p, perPixel, frame.lines.y * 10.0, width);
        vec2 lines = max(max(minor, middling), major);
        float line = max(lines.x, lines.y);
        vec3 lineColor = dark ? vec3(0.34, 0.37, 0.43) : vec3(0.25, 0.28, 0.34);
        outColor = over(vec4(lineColor, 1.0) * line * (dark ? 0.26 : 0.22) * fade * grazing, outColor);
        float x = axisLine(p.y, perPixel.y, 1.6 * width), z = axisLine(p.x, perPixel.x, 1.6 * width);
        outColor = over(vec4(0.86, 0.13, 0.16, 1.0) * x * 0.75 * fade * grazing, outColor);
        outColor = over(vec4(0.10, 0.33, 0.92, 1.0) * z * 0.75 * fade * grazing, outColor);
    }
    if (above && frame.ground.z > 0.5) {
        vec2 at = (p - frame.patchArea.xy) / (2.0 * frame.patchArea.z) + 0.5;
        vec2 edge = smoothstep(0.0, 0.06, at) * smoothstep(0.0, 0.06, 1.0 - at);
        vec2 s = texture(shade, at).rg * edge.x * edge.y;
        float shadow = 1.0 - (1.0 - (dark ? 0.62 : 0.34) * s.g) * (1.0 - (dark ? 0.72 : 0.45) * s.r);
        outColor = over(vec4(dark ? vec3(0.004, 0.005, 0.007) : vec3(0.05, 0.06, 0.09), 1.0) * shadow * grazing, outColor);
    }
}
