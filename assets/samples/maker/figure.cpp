// SPDX-License-Identifier: GPL-3.0-or-later
// A bear cub in a striped jumper, like a vinyl toy. It looks along +z and stands on y = 0; its left is +x.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "character.h"

namespace imomushi::samples {

namespace {

const Vec3 kHead(0, 1.72, 0.02);
const Vec3 kShoulder(0.16, 1.26, 0);
const Vec3 kArm = Vec3(0.86, -0.50, 0.08).normalized();
constexpr double kHipX = 0.185;

Vec3 fold(const Vec3& p) { return {std::abs(p.x()), p.y(), p.z()}; }

double ears(const Vec3& q) { return ellipsoid(q, {0.315, 2.045, -0.02}, {0.135, 0.135, 0.075}); }
double muzzle(const Vec3& p) { return ellipsoid(p, {0, 1.615, 0.345}, {0.155, 0.115, 0.12}); }
const Vec3 kThumb(0.925, 0.93, 0.095);
Vec3 armAt(double s) { return kShoulder + s * kArm; }

double shape(const Vec3& p) {
    const Vec3 q = fold(p);
    double head = ellipsoid(p, kHead, {0.44, 0.385, 0.385});
    head = blend(head, muzzle(p), 0.06);
    head = blend(head, ears(q), 0.05);
    double d = ellipsoid(p, {0, 1.04, 0}, {0.30, 0.37, 0.255});
    d = blend(d, taperedCapsule(p, {0, 1.28, 0}, {0, 1.42, 0}, 0.19, 0.19), 0.06);
    d = blend(d, head, 0.05);
    double arm = taperedCapsule(q, armAt(0), armAt(0.80), 0.118, 0.098);
    arm = blend(arm, ellipsoid(q, armAt(0.90), {0.135, 0.12, 0.115}), 0.05);
    arm = blend(arm, taperedCapsule(q, armAt(0.84), kThumb, 0.055, 0.048), 0.06);
    d = blend(d, arm, 0.08);
    double leg = taperedCapsule(q, {kHipX - 0.03, 0.80, 0}, {kHipX, 0.16, 0}, 0.142, 0.125);
    leg = blend(leg, ellipsoid(q, {kHipX + 0.015, 0.105, 0.075}, {0.145, 0.105, 0.215}), 0.06);
    return blend(d, leg, 0.06);
}

enum Part { kHeadPart, kTrunk, kUpperArmL, kLowerArmL, kHandL, kUpperArmR, kLowerArmR, kHandR, kUpperLegL, kLowerLegL, kFootL, kUpperLegR, kLowerLegR, kFootR };

Vec3 paint(int element, const Vec3& p, const Vec3& n, double texel) {
    const Vec3 fur = rgb(0xd9975a), cream = rgb(0xfbe6c4), navy = rgb(0x35557f), white = rgb(0xfbf7ee), shorts = rgb(0xe2574c), sole = rgb(0xa8683c);
    const double soft = 1.5 * texel;
    const Vec3 q = fold(p);
    // The jumper's stripes, `s` metres from where they start, each 5 cm wide.
    const auto jumper = [&](double s) {
        const double wave = 0.025 - std::abs(s - 0.1 * std::floor(s / 0.1) - 0.05);
        return mix(white, navy, cover(wave, soft));
    };
    switch (element) {
        case kHeadPart: {
            Vec3 c = mix(fur, rgb(0xe8ad70), std::clamp(n.y(), 0.0, 1.0) * 0.5);
            c = mix(c, cream, cover(muzzle(p) - 0.016, 0.02));
            const auto ear = onPicture(q, {0.325, 2.05, 0.05}, Vec3::UnitZ(), Vec3::UnitY());
            if (n.z() > 0 && p.z() > 0 && p.z() < 0.2 && ears(q) < 0.012) c = mix(c, rgb(0xf7b9a0), cover(ovalDistance(ear, {0, 0}, {0.085, 0.085}), 0.02));
            if (p.z() > 0) {
                for (double side : {-1.0, 1.0}) {
                    const Vec3 look = Vec3(side * 0.40, 0.06, 0.91).normalized();
                    if (n.dot(look) > 0) c = paintEye(c, onPicture(p, kHead + 0.39 * look, look, Vec3::UnitY()), {0.058, 0.080}, texel);
                    const Vec3 cheek = Vec3(side * 0.66, -0.26, 0.72).normalized();
                    if (n.dot(cheek) > 0) c = mix(c, rgb(0xff8a78), 0.7 * cover(ovalDistance(onPicture(p, kHead + 0.40 * cheek, cheek, Vec3::UnitY()), {0, 0}, {0.062, 0.042}), 0.035));
                }
                const auto front = onPicture(p, {0, 1.615, 0.4}, Vec3::UnitZ(), Vec3::UnitY());
                c = mix(c, rgb(0x4a2a22), cover(ovalDistance(front, {0, 0.062}, {0.052, 0.034}), soft));
                c = mix(c, Vec3::Ones(), 0.8 * cover(ovalDistance(front, {-0.016, 0.073}, {0.014, 0.008}), soft));
                for (double side : {-1.0, 1.0}) c = mix(c, rgb(0x4a2a22), smile(front, {side * 0.032, 0.010}, 0.032, 1.35, 0.011, texel));
            }
            return c;
        }
        case kTrunk: {
            Vec3 c = jumper(p.y() - 0.78);
            c = mix(c, navy, cover(1.30 - p.y(), soft));  // collar
            return mix(c, shorts, cover(p.y() - 0.80, soft));
        }
        case kUpperArmL: case kUpperArmR: return jumper((q - kShoulder).dot(kArm) + 0.035);
        case kLowerArmL: case kLowerArmR: {
            const double s = (q - kShoulder).dot(kArm);
            return mix(mix(jumper(s + 0.035), navy, cover(0.625 - s, soft)), fur, cover(0.665 - s, soft));
        }
        case kHandL: case kHandR: return fur;
        case kUpperLegL: case kUpperLegR: return mix(shorts, white, cover(std::abs(p.y() - 0.475) - 0.018, soft));
        case kLowerLegL: case kLowerLegR: return fur;
        default: {
            Vec3 c = mix(fur, cream, cover(n.y() + 0.75, 0.3));
            return mix(c, sole, 0.25 * cover(p.y() - 0.02, 0.03));
        }
    }
}

}  // namespace

CharacterSpec figure() {
    CharacterSpec c;
    c.name = "figure";
    c.shape = shape;
    c.paint = paint;
    c.shade = 0.28;
    const Vec3 up = Vec3::UnitY();
    const double shoulder = 0.285, elbow = 0.505, wrist = 0.735, hip = 0.605, knee = 0.40, ankle = 0.215;
    std::vector<std::pair<Vec3, double>> rims = {{{0, 1.365, 0}, 0.19}};
    for (double s : {shoulder, elbow, wrist}) rims.push_back({armAt(s), 0.105});
    for (double y : {hip, knee, ankle}) rims.push_back({{kHipX, y, 0}, 0.13});
    c.size = [rims](const Vec3& p) {
        const Vec3 q = fold(p);
        double h = 0.080;
        for (const auto& [centre, r] : rims) h = std::min(h, 0.325 * r + 0.30 * std::max((q - centre).norm() - 1.2 * r, 0.0));
        h = std::min(h, 0.036 + 0.3 * std::max((q - kThumb).norm() - 0.06, 0.0));
        h = std::min(h, 0.048 + 0.3 * std::max(ears(q), 0.0));
        return std::min(h, 0.052 + 0.3 * std::max(muzzle(p), 0.0));
    };
    c.elements.push_back({"head", {0, 1.72, 0.0}, 0, 1280, up, -Vec3::UnitZ()});
    c.elements.push_back({"trunk", {0, 1.02, 0}, 0, 768, up, -Vec3::UnitZ(), true});
    c.joints.push_back({1, 0, {0, 1.365, 0}, up, 26, {18, 11, 4}});
    c.bones = {{"spine-bone", "trunk", Vec3(0, 0.78, 0), Vec3(0, 1.16, 0), ""},
               {"neck-bone", "trunk", "spine-bone/end", "trunk/head", "spine-bone"},
               {"head-bone", "head", "neck-bone/end", Vec3(0, 2.06, 0.0), "neck-bone"}};
    for (const double side : {1.0, -1.0}) {
        const std::string mark = side > 0 ? ".L" : ".R";
        const auto mirror = [&](const Vec3& v) { return Vec3(side * v.x(), v.y(), v.z()); };
        const auto add = [&](const std::string& name, const Vec3& centre, const Vec3& pole, int width, const Vec3& seam) {
            c.elements.push_back({name + mark, mirror(centre), 0, width, mirror(pole), seam, name != "hand"});
            return int(c.elements.size()) - 1;
        };
        const int upper = add("upper-arm", armAt((shoulder + elbow) / 2), -kArm, 384, -Vec3::UnitZ());
        const int lower = add("lower-arm", armAt((elbow + wrist) / 2), -kArm, 384, -Vec3::UnitZ());
        const int hand = add("hand", armAt(0.875) + Vec3(0, 0, 0.02), -kArm, 256, -Vec3::UnitZ());
        c.joints.push_back({1, upper, mirror(armAt(shoulder)), mirror(kArm), 20, {13, 6, 1}});
        c.joints.push_back({upper, lower, mirror(armAt(elbow)), mirror(kArm), 20, {13, 6, 1}});
        c.joints.push_back({lower, hand, mirror(armAt(wrist)), mirror(kArm), 20, {13, 6, 1}});
        const std::string u = "upper-arm" + mark, l = "lower-arm" + mark, h = "hand" + mark;
        c.bones.push_back({"shoulder-bone" + mark, "trunk", "spine-bone/end", "trunk/" + u, "spine-bone"});
        c.bones.push_back({"upper-arm-bone" + mark, u, "shoulder-bone" + mark + "/end", u + "/" + l, "shoulder-bone" + mark});
        c.bones.push_back({"lower-arm-bone" + mark, l, "upper-arm-bone" + mark + "/end", l + "/" + h, "upper-arm-bone" + mark});
        c.bones.push_back({"hand-bone" + mark, h, "lower-arm-bone" + mark + "/end", mirror(armAt(1.0)), "lower-arm-bone" + mark});
    }
    for (const double side : {1.0, -1.0}) {
        const std::string mark = side > 0 ? ".L" : ".R";
        const double x = side * kHipX;
        const auto add = [&](const std::string& name, const Vec3& centre, int width) {
            c.elements.push_back({name + mark, {side * centre.x(), centre.y(), centre.z()}, 0, width, up, -Vec3::UnitZ(), name != "foot"});
            return int(c.elements.size()) - 1;
        };
        const int upper = add("upper-leg", {kHipX, (hip + knee) / 2, 0}, 384);
        const int lower = add("lower-leg", {kHipX, (knee + ankle) / 2, 0}, 128);
        const int foot = add("foot", {kHipX, 0.125, 0.03}, 256);
        // Tilted: two discs in one plane could not be told apart by their plane.
        c.joints.push_back({1, upper, {x, hip, 0}, Vec3(0.15 * side, -1, 0), 22, {14, 7, 1}});
        c.joints.push_back({upper, lower, {x, knee, 0}, -up, 22, {14, 7, 1}});
        c.joints.push_back({lower, foot, {x, ankle, 0}, -up, 22, {14, 7, 1}});
        const std::string u = "upper-leg" + mark, l = "lower-leg" + mark, f = "foot" + mark;
        c.bones.push_back({"hip-bone" + mark, "trunk", "spine-bone/start", "trunk/" + u, "spine-bone"});
        c.bones.push_back({"upper-leg-bone" + mark, u, "hip-bone" + mark + "/end", u + "/" + l, "hip-bone" + mark});
        c.bones.push_back({"lower-leg-bone" + mark, l, "upper-leg-bone" + mark + "/end", l + "/" + f, "upper-leg-bone" + mark});
        c.bones.push_back({"foot-bone" + mark, f, "lower-leg-bone" + mark + "/end", Vec3(side * (kHipX + 0.015), 0.07, 0.24), "lower-leg-bone" + mark});
    }
    c.stretch(0.8, 1.3, "");
    c.stretch(0.92, 1.12, "shoulder-bone");
    c.stretch(0.92, 1.12, "hip-bone");
    c.pins = {"foot-bone.L/end", "foot-bone.R/end"};
    c.stands = true;
    return c;
}

}  // namespace imomushi::samples
