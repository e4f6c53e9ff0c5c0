// SPDX-License-Identifier: GPL-3.0-or-later
// The studio floor: a pool of light, soft shadows, and lines whose width is constant on the screen and that fade before they flicker.
uniform vec2 middle;      // x, z where the ground is not yet faded
uniform sampler2D shade;  // of ground_shadow.frag

// Coverage of lines every `spacing` = 1 / `density` metres, `width` pixels wide; `pixels`: in a metre, the inverse of `perPixel`; what is too dense becomes its own average.
vec2 gridLines(vec2 p, vec2 perPixel, vec2 pixels, float density, float spacing, float width) {
    vec2 d = perPixel * density;
    vec2 off = 0.5 - abs(fract(p * density) - 0.5);
    vec2 lines = clamp(0.5 + 0.5 * width - off * (pixels * spacing), 0.0, 1.0);
    return mix(lines, min(width * d, 1.0), clamp(3.0 * d - 0.75, 0.0, 1.0));
}

vec4 over(vec4 top, vec4 below) { return top + below * (1.0 - top.a); }

// Premultiplied colour of the floor at the point p (x, z) of it; `grazing`: sine of the angle at which it is seen. Polynomials and few
// divisions: on a computer without a graphics card this is most of the picture.
vec4 floorColor(vec2 p, vec2 perPixel, float grazing) {
    bool dark = frame.ground.w > 0.5;
    bool above = frame.eye.w > 0.5 ? frame.forward.y < 0.0 : frame.eye.y > frame.ground.x;
    vec2 fromMiddle = (p - middle) / frame.lines.w;
    float fade = clamp(1.13 - dot(fromMiddle, fromMiddle) * 1.6 - 0.6 * length(fromMiddle), 0.0, 1.0);
    grazing = clamp(grazing * 5.5, 0.0, 1.0);
    fade *= fade * grazing;
    vec4 color = vec4(0.0);

    // The pool of light under the character, only where there is a background to lighten.
    vec2 q = (p - frame.sphere.xz) / (2.0 * frame.sphere.w);
    float pool = 1.0 / (1.0 + dot(q, q));
    pool *= pool * grazing * frame.ground.y * (above ? 1.0 : 0.0);
    color = vec4(dark ? vec3(0.115, 0.125, 0.150) : vec3(0.97, 0.975, 0.985), 1.0) * pool * (dark ? 0.55 : 0.6);

    if (frame.right.w > 0.5) {
        float sheet = (above ? 0.62 : 0.3) * fade;
        color = over(vec4((dark ? vec3(0.105, 0.114, 0.138) : vec3(0.93, 0.94, 0.96)) * sheet, sheet), color);
    }
    if (frame.ground.y > 0.5) {
        float width = frame.forward.w, next = frame.lines.z, spacing = frame.lines.y, density = 1.0 / spacing;
        vec2 pixels = 1.0 / perPixel;
        vec2 minor = gridLines(p, perPixel, pixels, density * 10.0, spacing * 0.1, width) * 0.42 * (1.0 - next);
        vec2 middling = gridLines(p, perPixel, pixels, density, spacing, width) * (1.0 - 0.58 * next);
        vec2 major = gridLines(p, perPixel, pixels, density * 0.1, spacing * 10.0, width);
        vec2 lines = max(max(minor, middling), major);
        float line = max(lines.x, lines.y) * (dark ? 0.26 : 0.22) * fade;
        color = over(vec4((dark ? vec3(0.34, 0.37, 0.43) : vec3(0.25, 0.28, 0.34)) * line, line), color);
        vec2 axes = clamp(0.5 + 0.8 * width - abs(p.yx) * pixels.yx, 0.0, 1.0) * 0.75 * fade;
        color = over(vec4(0.86, 0.13, 0.16, 1.0) * axes.x, color);
        color = over(vec4(0.10, 0.33, 0.92, 1.0) * axes.y, color);
    }
    vec2 at = (p - frame.patchArea.xy) / (2.0 * frame.patchArea.z) + 0.5;
    vec2 edge = clamp(16.0 * min(at, 1.0 - at), 0.0, 1.0);
    vec2 s = texture(shade, at).rg * (edge.x * edge.y * frame.ground.z * (above ? 1.0 : 0.0));
    float shadow = (1.0 - (1.0 - (dark ? 0.62 : 0.34) * s.g) * (1.0 - (dark ? 0.72 : 0.45) * s.r)) * grazing;
    return over(vec4((dark ? vec3(0.004, 0.005, 0.007) : vec3(0.05, 0.06, 0.09)) * shadow, shadow), color);
}
