// SPDX-License-Identifier: GPL-3.0-or-later
#version 330 core
void main() {}
