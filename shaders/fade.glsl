// SPDX-License-Identifier: GPL-3.0-or-later
// How visible a marker is at `depth` metres in front of the eye: 1 in front of bodies, `behind` well inside or behind them.
uniform sampler2D surface;
float fadeBehind(float depth, float behind) {
    float body = texture(surface, gl_FragCoord.xy * frame.viewport.zw).x;
    return mix(1.0, behind, smoothstep(0.008, 0.05, (depth - body) / frame.sphere.w));
}
