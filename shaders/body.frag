// SPDX-License-Identifier: GPL-3.0-or-later
// A soft studio: a warm key light with shadow, a cool fill beside the camera, a rim light behind, a hemisphere around. Metallic-roughness as in
// glTF, with light that wraps a little past the terminator, most where the colour is bright: soft characters are never black.
#version 330 core
#include "frame.glsl"
#include "tone.glsl"
in vec3 worldPosition;
in vec3 worldNormal;
in vec2 uv;
in vec4 vertexColor;
uniform vec3 baseColor;  // linear
uniform float metallic;
uniform float roughness;
uniform bool textured;
uniform sampler2D baseTexture;
uniform sampler2D occlusionMap;  // of occlusion.frag
uniform float opacity;
uniform float hovered;
uniform float outdated;
uniform bool dataColors;
out vec4 outColor;

const vec3 kKey = vec3(1.00, 0.955, 0.895) * 0.92;
const vec3 kFill = vec3(0.74, 0.86, 1.00) * 0.20;
const vec3 kRim = vec3(0.80, 0.90, 1.00) * 0.55;
const vec3 kSky = vec3(0.36, 0.405, 0.47);
const vec3 kFloor = vec3(0.205, 0.18, 0.165);
const float kPi = 3.14159265;

float fifth(float x) { return x * x * x * x * x; }

// GGX with the height-correlated Smith visibility in Hammon's approximation; times pi, as the lights are.
float specularLobe(float nl, float nv, float nh, float alpha) {
    float a2 = alpha * alpha;
    float d = (nh * a2 - nh) * nh + 1.0;
    return a2 / (d * d) * 0.5 / max(mix(2.0 * nl * nv, nl + nv, alpha), 1e-4);
}

// What the studio around looks like in a mirror of this roughness: floor, walls, a soft box overhead.
vec3 surroundings(vec3 r, float rough) {
    float blur = 0.12 + 0.7 * rough;
    vec3 c = mix(kFloor * 0.8, kSky * 1.15, smoothstep(-blur, blur, r.y));
    c += vec3(0.55) * smoothstep(0.86 - 0.5 * rough, 0.97, r.y) * (1.0 - 0.7 * rough);
    return c;
}

void main() {
    vec3 n = normalize(gl_FrontFacing ? worldNormal : -worldNormal);  // back faces are drawn of open meshes only
    vec3 v = towardsEye(worldPosition);
    float nv = clamp(dot(n, v), 1e-3, 1.0);

    vec3 base = baseColor * vertexColor.rgb;
    if (textured) base *= texture(baseTexture, uv).rgb;
    vec3 diffuse = base * (1.0 - metallic);
    vec3 f0 = mix(vec3(0.04), base, metallic);
    float rough = clamp(roughness, 0.08, 1.0);
    float alpha = rough * rough;

    // What an x-ray body shows lies behind others in that map.
    vec2 screen = opacity < 0.99 ? vec2(1.0) : texture(occlusionMap, gl_FragCoord.xy * frame.viewport.zw).rg;
    float occlusion = screen.r, visible = screen.g;
    // Near the ground less of the hemisphere is open below.
    float height = (worldPosition.y - frame.ground.x) / (0.35 * frame.sphere.w);
    occlusion *= mix(1.0, mix(0.72 + 0.28 * clamp(n.y, 0.0, 1.0), 1.0, clamp(height, 0.0, 1.0)), frame.ground.z);
    // Light that bounces in crevices takes the colour of the surface (Jimenez et al. 2016).
    vec3 bounced = max(vec3(occlusion), ((occlusion * (2.0404 * base - 0.3324) + (-4.7951 * base + 0.6417)) * occlusion
                                         + (2.7552 * base + 0.6903)) * occlusion);

    // Key
    vec3 l = frame.keyDirection.xyz;
    vec3 h = normalize(l + v);
    float nl = dot(n, l);
    vec3 wrap = 0.16 + 0.22 * diffuse;
    vec3 lit = max((nl + wrap) / (1.0 + wrap), 0.0);
    lit *= lit * 0.35 + 0.65;
    float unshaded = mix(1.0, visible, smoothstep(-0.1, 0.35, nl));
    vec3 light = diffuse * kKey * lit * unshaded;
    float fh = fifth(1.0 - clamp(dot(l, h), 0.0, 1.0));
    float nlc = max(nl, 0.0);
    light += (f0 + (1.0 - f0) * fh) * specularLobe(nlc, nv, clamp(dot(n, h), 0.0, 1.0), max(alpha, 0.03)) * nlc * visible * kKey;

    // Fill: a large box beside the camera
    vec3 fillDirection = normalize(-frame.forward.xyz + 0.7 * frame.right.xyz + vec3(0.0, 0.15, 0.0));
    light += diffuse * kFill * (0.4 + 0.6 * max(dot(n, fillDirection), 0.0)) * bounced;

    // Hemisphere
    light += diffuse * mix(kFloor, kSky, n.y * 0.5 + 0.5) * bounced;
    vec3 r = reflect(-v, n);
    vec4 fit = rough * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);  // Karis 2014, environment BRDF
    float g = min(fit.x * fit.x, exp2(-9.28 * nv)) * fit.x + fit.y;
    vec2 scale = vec2(-1.04, 1.04) * g + fit.zw;
    light += (f0 * scale.x + scale.y) * surroundings(r, rough) * occlusion;

    // Rim: from behind and above, seen at grazing angles only
    float edge = (1.0 - nv) * (1.0 - nv) * (1.0 - nv);
    light += kRim * edge * smoothstep(-0.35, 0.8, n.y + 0.35 * dot(n, -frame.forward.xyz)) * (0.25 + 0.75 * base) * occlusion;

    vec3 color = toneMap(light);

    // Out of date: calmer colours under diagonal hatching that keeps its width on the screen.
    if (outdated > 0.5) {
        float grey = dot(color, vec3(0.2126, 0.7152, 0.0722));
        color = mix(color, vec3(grey), 0.45);
        float period = 9.0 * frame.forward.w;
        float along = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / period) - 0.5) * period;
        color *= mix(1.0, 0.72, 1.0 - smoothstep(1.1 * frame.forward.w, 1.1 * frame.forward.w + 1.0, along));
    }
    // Data keeps its colour, but for a little shape: 0.8 to 1 of its sRGB value, lit from above the camera.
    if (dataColors) {
        vec3 above = normalize(0.3 * frame.right.xyz + 0.5 * frame.above.xyz - 0.81 * frame.forward.xyz);
        color = base * pow(0.8 + 0.2 * max(dot(n, above), 0.0), 2.2);
    }
    if (hovered > 0.5) color = mix(color, vec3(0.55, 0.80, 1.0), 0.03 + 0.22 * edge);
    outColor = vec4(color, 1.0) * opacity;
}
