// SPDX-License-Identifier: GPL-3.0-or-later
// The picture over its background, encoded for display, with noise of half a step so that the gradient shows no bands.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
in vec2 uv;
uniform sampler2D picture;  // linear, premultiplied
uniform bool transparent;
out vec4 outColor;

void main() {
    vec4 c = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    if (transparent) {
        outColor = vec4(encodeSrgb(c.rgb / max(c.a, 1e-4)) * c.a, c.a);
        return;
    }
    bool dark = frame.ground.w > 0.5;
    vec2 q = (uv - vec2(0.5, 0.58)) * vec2(frame.viewport.x * frame.viewport.w, 1.0);
    float glow = exp(-1.5 * dot(q, q));
    float t = smoothstep(0.0, 1.0, uv.y);
    vec3 back = dark ? mix(vec3(0.0105, 0.0118, 0.0150), vec3(0.0215, 0.0242, 0.0305), t) + vec3(0.0165, 0.0190, 0.0245) * glow
                     : mix(vec3(0.600, 0.635, 0.690), vec3(0.760, 0.785, 0.825), t) + vec3(0.10) * glow;
    vec3 color = encodeSrgb(c.rgb + back * (1.0 - c.a));
    float noise = pixelNoise(floor(gl_FragCoord.xy)) - 0.5;
    outColor = vec4(color + noise / 255.0, 1.0);
}
