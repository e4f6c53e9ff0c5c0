// SPDX-License-Identifier: GPL-3.0-or-later
// What an element is made of in a frame; laid out as CardDeformer writes it.
layout(std140) uniform Drive {
    vec4 shape[3];       // rows: linear, shift
    vec4 placement[3];
    ivec4 size;          // fours of modes, vertices, fours of shapes, whether responses are integers
    vec4 numbers[1000];  // weights of modes by four; then per face: three rows of its joint, its normal, three rows of warping for each four shapes
} drive;

int firstOfFace(int face) { return drive.size.x + face * (4 + 3 * drive.size.z); }
