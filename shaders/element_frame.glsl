// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of one element in one frame, from which deform.vert and display_vertices.vert compute it; GpuDeformer::uploadFrame() writes them.
layout(std140) uniform ElementState {
    vec4 shape[3];       // rows: linear, shift
    vec4 placement[3];
    ivec4 size;          // modes / 4, vertices, shapes / 4 (both rounded up), whether responses are integers
    vec4 numbers[1000];  // weights of modes, four to a vector; then per place (faces, then attached parts): three rows of what it does, the normal of a face, three rows of warping for each four shapes
} element;

int firstOfFace(int face) { return element.size.x + face * (4 + 3 * element.size.z); }
