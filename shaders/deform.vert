// SPDX-License-Identifier: GPL-3.0-or-later
// Body vertices of one element from its joint parameters (core/character/surface_recipe.h), one per point. Four modes share a texel, and vertices that
// follow each other read texels that do.
#version 330 core
#include "drive.glsl"
layout(location = 0) in vec3 rest;           // m: from the middle of the element, or from the rest place of its joint
layout(location = 1) in ivec2 held;          // face (-1: free), index among held vertices
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
        at = transformed(drive.shape[0], drive.shape[1], drive.shape[2], rest);
        int texel = gl_VertexID;
        if (drive.size.w != 0) {
            for (int q = 0; q < drive.size.x; ++q) {
                vec4 w = drive.numbers[q];
                at.x += dot(vec4(texelFetch(integerResponse, texel)), w);
                at.y += dot(vec4(texelFetch(integerResponse, texel + drive.size.y)), w);
                at.z += dot(vec4(texelFetch(integerResponse, texel + 2 * drive.size.y)), w);
                texel += 3 * drive.size.y;
            }
        } else {
            for (int q = 0; q < drive.size.x; ++q) {
                vec4 w = drive.numbers[q];
                at.x += dot(texelFetch(response, texel), w);
                at.y += dot(texelFetch(response, texel + drive.size.y), w);
                at.z += dot(texelFetch(response, texel + 2 * drive.size.y), w);
                texel += 3 * drive.size.y;
            }
        }
        at = transformed(drive.placement[0], drive.placement[1], drive.placement[2], at);
    } else {
        int n = firstOfFace(held.x);
        at = transformed(drive.numbers[n], drive.numbers[n + 1], drive.numbers[n + 2], rest);
        for (int q = 0; q < drive.size.z; ++q) {
            vec4 s = texelFetch(shapes, held.y * drive.size.z + q);
            int w = n + 4 + 3 * q;
            at += vec3(dot(drive.numbers[w], s), dot(drive.numbers[w + 1], s), dot(drive.numbers[w + 2], s));
        }
    }
    point = vec4(at, 1.0);
}
