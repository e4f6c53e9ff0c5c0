// SPDX-License-Identifier: GPL-3.0-or-later
// Which body (1...) and which of its drawn triangles covers a pixel.
#version 330 core
uniform uint body;
out uvec2 outIdentity;
void main() { outIdentity = uvec2(body, uint(gl_PrimitiveID)); }
