// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
#include "frame.glsl"
#include "fade.glsl"
in vec4 lineColor;
in float depth;
noperspective in float across;
flat in vec3 lineWidths;
out vec4 outColor;
void main() {
    float d = abs(across);
    float core = 1.0 - smoothstep(lineWidths.x - 0.5, lineWidths.x + 0.5, d);
    float glow = lineWidths.y > 0.0 ? clamp(1.0 - (d - lineWidths.x) / lineWidths.y, 0.0, 1.0) : 0.0;
    float alpha = max(core, 0.34 * glow * glow) * lineColor.a * fadeBehind(depth, lineWidths.z);
    outColor = vec4(mix(lineColor.rgb, vec3(1.0), lineWidths.y > 0.0 ? 0.18 * core : 0.0), 1.0) * alpha;
}
