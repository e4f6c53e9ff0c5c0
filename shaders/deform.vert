// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices of one element from its joint parameters (core/character/deform_input.h), one per point. Four modes share a texel, and vertices that
// follow each other read texels that do.
#version 330 core
#include "element_frame.glsl"
layout(location = 0) in vec3 rest;           // m: from the middle of the element, or from the rest place of its joint
layout(location = 1) in ivec2 held;          // place (-1: free); index among held vertices, or the face of a joint part (-1: none)
layout(location = 2) in vec3 offset;         // m, of a joint part
uniform samplerBuffer response;              // per four modes, per axis, per vertex
uniform isamplerBuffer integerResponse;      // the same, of 16-bit integers
uniform samplerBuffer shapes;                // per held vertex, per four shapes
out vec4 point;                              // m, world

vec3 transformed(vec4 x, vec4 y, vec4 z, vec3 p) {
    return vec3(dot(x.xyz, p), dot(y.xyz, p), dot(z.xyz, p)) + vec3(x.w, y.w, z.w);
}

void main() {
    vec3 at;
    if (held.x < 0) {
        at = transformed(element.shape[0], element.shape[1], element.shape[2], rest);
        int texel = gl_VertexID;
        if (element.size.w != 0) {
            for (int q = 0; q < element.size.x; ++q) {
                vec4 w = element.numbers[q];
                at.x += dot(vec4(texelFetch(integerResponse, texel)), w);
                at.y += dot(vec4(texelFetch(integerResponse, texel + element.size.y)), w);
                at.z += dot(vec4(texelFetch(integerResponse, texel + 2 * element.size.y)), w);
                texel += 3 * element.size.y;
            }
        } else {
            for (int q = 0; q < element.size.x; ++q) {
                vec4 w = element.numbers[q];
                at.x += dot(texelFetch(response, texel), w);
                at.y += dot(texelFetch(response, texel + element.size.y), w);
                at.z += dot(texelFetch(response, texel + 2 * element.size.y), w);
                texel += 3 * element.size.y;
            }
        }
        at = transformed(element.placement[0], element.placement[1], element.placement[2], at);
        if (held.y >= 0) {
            int n = firstOfFace(held.y);
            at += vec3(dot(element.numbers[n].xyz - element.placement[0].xyz, offset), dot(element.numbers[n + 1].xyz - element.placement[1].xyz, offset),
                       dot(element.numbers[n + 2].xyz - element.placement[2].xyz, offset));
        }
    } else {
        int n = firstOfFace(held.x);
        at = transformed(element.numbers[n], element.numbers[n + 1], element.numbers[n + 2], rest);
        for (int q = 0; q < element.size.z; ++q) {
            vec4 s = texelFetch(shapes, held.y * element.size.z + q);
            int w = n + 4 + 3 * q;
            at += vec3(dot(element.numbers[w], s), dot(element.numbers[w + 1], s), dot(element.numbers[w + 2], s));
        }
    }
    point = vec4(at, 1.0);
}
