// SPDX-License-Identifier: GPL-3.0-or-later
// What lies nearest in a pixel, in two numbers: its distance in front of the eye (m; beyond 1e20: nothing), and its normal in the space of the view, packed: the octahedron (Cigolle et al., JCGT 3, 2014) in 12 bits for each side,
// 0.03 degrees, which is a whole number that a float holds.
vec2 signs(vec2 v) { return vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0); }

float packedNormal(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z < 0.0) p = (1.0 - abs(p.yx)) * signs(p);
    vec2 whole = floor((0.5 * p + 0.5) * 4095.0 + 0.5);
    return 4096.0 * whole.x + whole.y;
}

vec3 unpackedNormal(float number) {
    float x = floor(number / 4096.0);
    vec2 p = vec2(x, number - 4096.0 * x) / 4095.0 * 2.0 - 1.0;
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * signs(n.xy);
    return normalize(n);
}
