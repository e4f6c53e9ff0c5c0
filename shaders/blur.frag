// SPDX-License-Identifier: GPL-3.0-or-later
// One direction of a Gaussian blur: red over the whole `stride`, green over a third of it.
#version 330 core
in vec2 uv;
uniform sampler2D image;
uniform vec2 stride;  // in texture coordinates
out vec4 outColor;

void main() {
    vec2 sum = vec2(0.0);
    float weights = 0.0;
    for (int i = -6; i <= 6; ++i) {
        float w = exp(-float(i * i) / 14.0);
        vec2 offset = stride * (float(i) / 6.0);
        sum += w * vec2(texture(image, uv + offset).r, texture(image, uv + offset / 3.0).g);
        weights += w;
    }
    outColor = vec4(sum / weights, 0.0, 1.0);
}
