// SPDX-License-Identifier: GPL-3.0-or-later
// Five elements along x, 1978 vertices in all, like the paper's experiment. It looks along +x.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "character.h"

namespace imomushi::samples {

namespace {

constexpr double kAxis = 0.33;  // height of the body's axis, m
const Vec3 kHead(1.02, 0.43, 0);
const double kSegments[] = {-0.46, 0.0, 0.46};

double feet(const Vec3& p) {
    double d = 1e9;
    for (double x : kSegments)
        for (double side : {-1.0, 1.0}) d = std::min(d, ellipsoid(p, {x, 0.085, side * 0.135}, {0.085, 0.085, 0.08}));
    return d;
}

/// The head looks a little to its side: a point as if it looked along +x, from the head's centre.
Vec3 facing(const Vec3& p) {
    const double c = std::cos(0.6), s = std::sin(0.6);
    const Vec3 d = p - kHead;
    return {c * d.x() + s * d.z(), d.y(), c * d.z() - s * d.x()};
}

double antennae(const Vec3& p) {
    const Vec3 q = facing(p);
    return taperedCapsule({q.x(), q.y(), std::abs(q.z())}, {-0.02, 0.25, 0.10}, {0.0, 0.50, 0.21}, 0.042, 0.058);
}

double body(const Vec3& p) {
    double d = ellipsoid(p, {-0.90, kAxis - 0.02, 0}, {0.27, 0.23, 0.24});
    for (double x : kSegments) d = blend(d, ellipsoid(p, {x, kAxis, 0}, {0.305, 0.275, 0.285}), 0.07);
    d = blend(d, ellipsoid(p, kHead, {0.345, 0.345, 0.37}), 0.08);
    d = blend(d, taperedCapsule(p, {-1.08, kAxis + 0.03, 0}, {-1.20, kAxis + 0.13, 0}, 0.075, 0.045), 0.12);
    d = blend(d, feet(p), 0.06);
    return blend(d, antennae(p), 0.06);
}

Vec3 paint(int element, const Vec3& p, const Vec3& n, double texel) {
    const Vec3 lime = rgb(0xb6dd4f), green = rgb(0x7cc653), teal = rgb(0x3fae83), cream = rgb(0xf6f0c2), coral = rgb(0xf2795b);
    const double soft = 1.5 * texel;
    if (element == 4) {
        Vec3 c = mix(rgb(0xc9e25a), rgb(0xdcec7c), std::clamp(n.y() * 0.5 + 0.5, 0.0, 1.0));
        c = mix(c, green, cover(p.x() - 0.80, 0.16));
        c = mix(c, coral, cover(antennae(p) - 0.022, 0.03) * cover(0.72 - p.y(), 0.08));
        const Vec3 q = facing(p), out = Vec3::UnitX(), up = Vec3::UnitY();
        if (q.x() > 0) {
            for (double side : {-1.0, 1.0}) {
                // Pictures that face half sideways, so that round things stay round.
                const Vec3 look = Vec3(0.87, 0.12, side * 0.46).normalized();
                if (q.dot(look) > 0) c = paintEye(c, onPicture(q, 0.35 * look, look, up), {0.072, 0.102}, texel);
                const Vec3 cheek = Vec3(0.73, -0.30, side * 0.66).normalized();
                if (q.dot(cheek) > 0)
                    c = mix(c, rgb(0xff8f7e), 0.8 * cover(ovalDistance(onPicture(q, 0.35 * cheek, cheek, up), {0, 0}, {0.058, 0.042}), 0.035));
            }
            c = mix(c, rgb(0x5a2f2a), smile(onPicture(q, Vec3::Zero(), out, up), {0, -0.045}, 0.075, 0.95, 0.020, texel));
        }
        return c;
    }
    const double along = std::clamp((p.x() + 1.2) / 1.95, 0.0, 1.0);
    Vec3 c = along < 0.5 ? mix(teal, green, 2 * along) : mix(green, lime, 2 * along - 1);
    // A lighter saddle on top of every second segment, and a cream belly.
    if (element % 2 == 1) c = mix(c, rgb(0xe6ef86), 0.28);
    c = mix(c, cream, 0.9 * cover((p.y() - kAxis) / std::hypot(p.y() - kAxis, p.z()) + 0.64, 0.12));
    c = mix(c, coral, cover(feet(p) - 0.018, 0.02) * cover(p.y() - 0.11, 0.05));
    // Buttons along both sides and on the back.
    for (double x : kSegments)
        for (double side : {-1.0, 1.0}) {
            const Vec3 look = Vec3(0, 0.42, side).normalized();
            const auto q = onPicture(p, Vec3(x, kAxis, 0) + 0.28 * look, look, Vec3::UnitY());
            if (n.dot(look) > 0.3) {
                c = mix(c, rgb(0xfff3a6), cover(q.norm() - 0.062, soft));
                c = mix(c, rgb(0xf7a23b), cover(q.norm() - 0.040, soft));
            }
        }
    if (element == 0) c = mix(c, coral, cover(p.x() + 1.13, 0.03) * cover(0.36 - p.y(), 0.05));
    return c;
}

}  // namespace

CharacterSpec caterpillar() {
    CharacterSpec c;
    c.name = "caterpillar";
    c.shape = body;
    c.paint = paint;
    c.size = [](const Vec3& p) {
        const double fine = std::min({feet(p), 1.3 * antennae(p) - 0.02, (p - Vec3(-1.20, kAxis + 0.13, 0)).norm() - 0.10});
        return std::clamp(0.036 + 0.35 * fine, 0.028, 0.066);
    };
    const char* names[] = {"tail", "rear", "middle", "front", "head"};
    const Vec3 centres[] = {{-0.88, kAxis - 0.02, 0}, {-0.46, kAxis - 0.02, 0}, {0, kAxis - 0.02, 0}, {0.46, kAxis - 0.02, 0}, kHead};
    const int vertices[] = {330, 384, 384, 384, 496};
    for (int i = 0; i < 5; ++i) c.elements.push_back({names[i], centres[i], vertices[i], i == 4 ? 1280 : 512, Vec3::UnitX(), -Vec3::UnitY()});
    c.elements[4].pole = Vec3::UnitY();
    c.elements[4].seam = -Vec3::UnitX();
    const double planes[] = {-0.695, -0.23, 0.23, 0.715};
    for (int i = 0; i < 4; ++i) {
        const double y = i == 3 ? kAxis + 0.035 : i == 0 ? kAxis - 0.01 : kAxis;
        c.joints.push_back({i, i + 1, {planes[i], y, 0}, Vec3::UnitX(), 22, {12, 6, 1}});
    }
    c.bones = {{"tail-bone", "tail", Vec3(-1.14, kAxis + 0.04, 0), "tail/rear", ""},
               {"rear-bone", "rear", "tail-bone/end", "rear/middle", "tail-bone"},
               {"middle-bone", "middle", "rear-bone/end", "middle/front", "rear-bone"},
               {"front-bone", "front", "middle-bone/end", "front/head", "middle-bone"},
               {"head-bone", "head", "front-bone/end", Vec3(1.30, 0.45, 0), "front-bone"}};
    c.pins = {"tail-bone/start"};
    c.stretch(0.65, 1.6, "");
    return c;
}

}  // namespace imomushi::samples
