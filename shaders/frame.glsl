// SPDX-License-Identifier: GPL-3.0-or-later
// What all passes of a frame share. Lengths in metres unless said otherwise; laid out as FrameBlock in ui/render/frame.h.
layout(std140) uniform Frame {
    mat4 viewProjection;
    mat4 view;
    mat4 shadow;         // world -> clip space of the key light
    vec4 eye;            // xyz; w: 1 where the camera is orthographic
    vec4 forward;        // unit, from the eye; w: device pixels per logical pixel
    vec4 keyDirection;   // unit, towards the key light; w: radius of the penumbra in shadow-map texture coordinates
    vec4 viewport;       // width, height in device pixels, and their inverses
    vec4 sphere;         // centre and radius of what is drawn
    vec4 ground;         // height, lines on, shadow on, dark theme
    vec4 patchArea;      // ground area the shadow texture covers: centre x, centre z, half width; w: height above which nothing darkens
    vec4 lines;          // spacing of fine and of middling grid lines, how far zoomed out towards the next decade, radius where the ground has faded
    vec4 projection;     // x, y: view-space slope (or half extent) at the edge of the picture; z: offset along normals for shadows in m; w: unused
    vec4 right;          // of the camera, unit; w: the ground is a plane that bodies rest on
    vec4 above;          // of the camera, unit; w: unused
} frame;

vec3 towardsEye(vec3 p) {
    return frame.eye.w > 0.5 ? -frame.forward.xyz : normalize(frame.eye.xyz - p);
}
