// SPDX-License-Identifier: GPL-3.0-or-later
// The picture over its background, encoded for display, with noise of half a step so that the gradient shows no bands.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
#include "floor.glsl"
in vec2 uv;
uniform sampler2D picture;  // linear, premultiplied
uniform bool transparent;
out vec4 outColor;

void main() {
    vec4 c = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);

    // The floor is where the ray through this pixel meets the ground; drawn here, its lines need no multisampling.
    vec2 slope = (uv * 2.0 - 1.0) * frame.projection.xy;
    vec3 across = frame.right.xyz * slope.x + frame.above.xyz * slope.y;
    bool flatView = frame.eye.w > 0.5;
    vec3 origin = flatView ? frame.eye.xyz + across : frame.eye.xyz;
    vec3 ray = flatView ? frame.forward.xyz : frame.forward.xyz + across;  // its length along the view is 1
    float depth = (frame.ground.x - origin.y) / (abs(ray.y) > 1e-5 ? ray.y : 1e-5);
    bool seen = depth > 1e-4 && depth < 1e3 * frame.lines.w;
    depth = seen ? depth : 1.0;
    vec2 p = (origin + ray * depth).xz;
    // How far p moves from one pixel to the next.
    float steep = flatView ? 1.0 : depth;
    vec2 turn = frame.projection.xy * 2.0 * frame.viewport.zw * steep;
    float perRay = 1.0 / (abs(ray.y) > 1e-5 ? ray.y : 1e-5);
    vec2 alongX = (frame.right.xz - ray.xz * (frame.right.y * perRay)) * turn.x;
    vec2 alongY = (frame.above.xz - ray.xz * (frame.above.y * perRay)) * turn.y;
    vec2 perPixel = abs(alongX) + abs(alongY) + 1e-7;
    vec4 ground = floorColor(p, perPixel, abs(ray.y) * inversesqrt(dot(ray, ray))) * (seen ? 1.0 : 0.0);
    // Seen from above the ground never hides a body that was dragged below it; seen from below its lines lie over everything.
    bool above = flatView ? frame.forward.y < 0.0 : frame.eye.y > frame.ground.x;
    bool dark = frame.ground.w > 0.5;
    vec2 q = (uv - vec2(0.5, 0.58)) * vec2(frame.viewport.x * frame.viewport.w, 1.0);
    float glow = 1.0 / (1.0 + 1.6 * dot(q, q));
    glow *= glow;
    float t = uv.y * uv.y * (3.0 - 2.0 * uv.y);
    vec3 back = dark ? mix(vec3(0.0105, 0.0118, 0.0150), vec3(0.0215, 0.0242, 0.0305), t) + vec3(0.0165, 0.0190, 0.0245) * glow
                     : mix(vec3(0.600, 0.635, 0.690), vec3(0.760, 0.785, 0.825), t) + vec3(0.10) * glow;
    // Where a pixel is covered in part, display values are mixed, not light: of a few samples a pixel light makes edges that look like stairs, bright over dark ones most.
    vec3 behind = above ? ground.rgb + back * (1.0 - ground.a) : back;
    vec3 color = encodeSrgb(behind), body = c.a > 0.0 ? encodeSrgb(c.rgb / max(c.a, 1e-4)) : vec3(0.0);
    color = mix(color, body, c.a);
    if (!above) color = encodeSrgb(ground.rgb / max(ground.a, 1e-4)) * ground.a + color * (1.0 - ground.a);
    c = above ? over(c, ground) : over(ground, c);
    float noise = (pixelNoise(floor(gl_FragCoord.xy)) - 0.5) / 255.0;
    outColor = transparent ? vec4(encodeSrgb(c.rgb / max(c.a, 1e-4)) * c.a, c.a) : vec4(color + noise, 1.0);
}
