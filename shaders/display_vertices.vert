// SPDX-License-Identifier: GPL-3.0-or-later
// Display vertices of one surface from the vertices of all elements, one per point: their positions, and their normals by core/character/normal_stencils.h or
// from the triangles around them.
#version 330 core
#include "element_frame.glsl"
layout(location = 0) in ivec4 source;   // vertex; kind of normal (NormalKind); two numbers of it (kind 0: stencil)
layout(location = 1) in float part;     // weight of the second vertex of a seam
uniform samplerBuffer positions;        // of the vertices of all elements
uniform isamplerBuffer stencils;        // per vertex of elements, then of render meshes: a, b, c, d
uniform samplerBuffer stencilParts;     // of each: two parts, scale
uniform isamplerBuffer corners;         // three vertices per triangle
out vec3 displayPosition;
out vec3 displayNormal;

vec3 at(int vertex) { return texelFetch(positions, vertex).xyz; }

vec3 stencilNormal(int vertex, int stencil) {
    ivec4 s = texelFetch(stencils, stencil);
    vec4 parts = texelFetch(stencilParts, stencil);
    vec3 c = at(s.z), e = at(vertex) - c;
    vec3 n = cross((at(s.x) - at(s.y) + parts.x * e) * parts.z, (at(s.w) - c + parts.y * e) * parts.z);
    float square = dot(n, n);
    return square < 1e-30 ? vec3(0.0, 0.0, 1.0) : n * inversesqrt(square);
}

void main() {
    displayPosition = at(source.x);
    if (source.y == 0) {
        displayNormal = stencilNormal(source.x, source.z);
    } else if (source.y == 1) {  // hidden: face
        displayNormal = element.numbers[firstOfFace(source.z) + 3].xyz;
    } else if (source.y == 2) {  // on a seam: from, to
        vec3 own = stencilNormal(source.x, source.x);
        vec3 sum = own + mix(stencilNormal(source.z, source.z), stencilNormal(source.w, source.w), part);
        displayNormal = dot(sum, sum) > 1e-6 ? normalize(sum) : own;
    } else {  // a hard edge: first triangle, number of triangles
        vec3 sum = vec3(0.0);
        for (int t = source.z; t < source.z + source.w; ++t) {
            vec3 a = at(texelFetch(corners, 3 * t).x);
            sum += cross(at(texelFetch(corners, 3 * t + 1).x) - a, at(texelFetch(corners, 3 * t + 2).x) - a);
        }
        // Areas of tiny meshes underflow when squared.
        float largest = max(abs(sum.x), max(abs(sum.y), abs(sum.z)));
        displayNormal = largest > 1e-30 ? normalize(sum / largest) : vec3(0.0, 1.0, 0.0);
    }
}
