// SPDX-License-Identifier: GPL-3.0-or-later
// Handles of constant size. Shapes tell them apart, colour only helps; a rim, dark around light ones and light around dark ones, keeps them readable on every background.
#version 330 core
#include "frame.glsl"
#include "fade.glsl"
in vec4 pointColor;
flat in vec3 pointShape;
noperspective in vec2 at;
in float depth;
out vec4 outColor;

float inside(float d) { return clamp(0.5 - d, 0.0, 1.0); }

void main() {
    float unit = frame.forward.w, r = pointShape.x;
    float fromCentre = length(at);
    float shape, rim;
    if (pointShape.y < 0.5) {
        shape = inside(abs(fromCentre - (r - 1.2 * unit)) - 1.2 * unit);
        rim = inside(abs(fromCentre - (r - 1.2 * unit)) - 2.4 * unit);
    } else if (pointShape.y < 1.5) {
        float d = min(fromCentre - 0.48 * r, abs(fromCentre - (r - 1.0 * unit)) - 1.0 * unit);
        shape = inside(d);
        rim = inside(d - 1.2 * unit);
    } else if (pointShape.y > 2.5) {
        float d = abs(max(abs(at.x), abs(at.y)) - (r - 1.0 * unit)) - 0.9 * unit;
        shape = inside(d);
        rim = inside(d - 1.3 * unit);
    } else {
        float d = (abs(at.x) + abs(at.y)) * 0.7071 - 0.72 * r;
        shape = inside(d) * (1.0 - inside(fromCentre - 0.26 * r));
        rim = inside(d - 1.4 * unit);
    }
    float alpha = max(shape, rim * 0.55) * pointColor.a * fadeBehind(depth, pointShape.z);
    vec3 rimColor = dot(pointColor.rgb, vec3(0.2126, 0.7152, 0.0722)) > 0.15 ? vec3(0.01, 0.012, 0.016) : vec3(0.9);
    outColor = vec4(mix(rimColor, pointColor.rgb, shape), 1.0) * alpha;
}
