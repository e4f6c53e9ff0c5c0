// SPDX-License-Identifier: GPL-3.0-or-later
// One segment of a polyline as a quad of constant width on the screen; mitred at both ends so that translucent neighbours do not overlap.
#version 330 core
#include "frame.glsl"
layout(location = 0) in vec3 before;
layout(location = 1) in vec3 from;
layout(location = 2) in vec3 to;
layout(location = 3) in vec3 after;
layout(location = 4) in vec4 color;   // linear, straight alpha
layout(location = 5) in vec3 widths;  // half width and reach of the glow, in device pixels; how visible it stays behind bodies
out vec4 lineColor;
out float depth;
noperspective out float across;       // device pixels from the middle
flat out vec3 lineWidths;

vec2 onScreen(vec4 clip) { return clip.xy / max(clip.w, 1e-6) * 0.5 * frame.viewport.xy; }
vec2 direction(vec2 a, vec2 b, vec2 otherwise) {
    vec2 d = b - a;
    float l = length(d);
    return l > 1e-3 ? d / l : otherwise;
}
// Cuts the part behind the eye away.
vec4 inFront(vec4 p, vec4 q) { return p.w > 1e-4 ? p : mix(p, q, clamp((1e-4 - p.w) / max(q.w - p.w, 1e-9), 0.0, 1.0)); }

void main() {
    vec4 ca = frame.viewProjection * vec4(from, 1.0), cb = frame.viewProjection * vec4(to, 1.0);
    vec4 a = inFront(ca, cb), b = inFront(cb, ca);
    vec4 p = inFront(frame.viewProjection * vec4(before, 1.0), a), q = inFront(frame.viewProjection * vec4(after, 1.0), b);
    bool end = (gl_VertexID & 1) == 1;
    float side = (gl_VertexID & 2) == 2 ? 1.0 : -1.0;
    vec2 sa = onScreen(a), sb = onScreen(b);
    vec2 along = direction(sa, sb, vec2(1.0, 0.0));
    vec2 other = end ? direction(sb, onScreen(q), along) : direction(onScreen(p), sa, along);
    vec2 across2 = vec2(-along.y, along.x);
    vec2 tangent = along + other;
    tangent = dot(tangent, tangent) > 0.05 ? normalize(tangent) : along;
    vec2 mitre = vec2(-tangent.y, tangent.x);
    float reach = widths.x + widths.y + 1.0;
    vec2 shift = mitre * side * reach / max(dot(mitre, across2), 0.5);
    vec4 here = end ? b : a;
    gl_Position = here + vec4(shift * 2.0 * frame.viewport.zw * here.w, 0.0, 0.0);
    lineColor = color;
    across = side * reach;
    lineWidths = widths;
    depth = -(frame.view * vec4(end ? to : from, 1.0)).z;
}
