// SPDX-License-Identifier: GPL-3.0-or-later
// Points spread evenly over the unit disc (Vogel's spiral).
const int kTaps = 12;
const vec2 kDiscSamples[kTaps] = vec2[kTaps](
    vec2(0.204124, 0.000000), vec2(-0.260699, 0.238826), vec2(0.039905, -0.454703), vec2(0.328594, 0.428586),
    vec2(-0.602999, -0.106664), vec2(0.571253, -0.363387), vec2(-0.189405, 0.711317), vec2(-0.363706, -0.701741),
    vec2(0.787114, 0.288202), vec2(-0.813163, 0.347525), vec2(0.379461, -0.854868), vec2(0.296560, 0.932745));
