// SPDX-License-Identifier: GPL-3.0-or-later
// Bones, arrow heads and gizmo planes: lit from the camera so that they read from every side.
#version 330 core
#include "frame.glsl"
#include "fade.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
in vec4 solidColor;
flat in float hidden;
in float depth;
out vec4 outColor;
void main() {
    vec3 n = normalize(worldNormal);
    vec3 v = towardsEye(worldPosition);
    vec3 l = normalize(v + vec3(0.0, 0.8, 0.0) - 0.6 * frame.right.xyz);
    float lit = 0.42 + 0.58 * max(dot(n, l), 0.0);
    float edge = pow(1.0 - abs(dot(n, v)), 3.0);
    float alpha = solidColor.a * fadeBehind(depth, hidden);
    outColor = vec4(solidColor.rgb * lit + 0.25 * edge * solidColor.rgb, 1.0) * alpha;
}
