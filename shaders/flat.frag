// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
uniform vec4 value;
out vec4 outValue;
void main() { outValue = value; }
