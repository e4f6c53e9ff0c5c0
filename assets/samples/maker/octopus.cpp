// SPDX-License-Identifier: GPL-3.0-or-later
// A body with eight arms of three elements each. It looks along +z and stands on y = 0.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "character.h"

namespace imomushi::samples {

namespace {

constexpr int kArms = 8;

double azimuth(int arm) { return (arm + 0.5) * 2 * M_PI / kArms; }

/// Arms in the plane of their azimuth: outwards, down to the ground, and up again at the tip; every second one curls more.
const Tube& arm(int index) {
    static const std::vector<Tube> arms = [] {
        std::vector<Tube> all;
        for (int i = 0; i < kArms; ++i) {
            const double a = azimuth(i), curl = i % 2 == 0 ? 1.0 : 0.45;
            const double profile[][2] = {{0.16, 0.42}, {0.36, 0.37}, {0.58, 0.25}, {0.82, 0.145}, {1.06, 0.11 + 0.01 * curl}, {1.27, 0.13 + 0.07 * curl}, {1.40 - 0.03 * curl, 0.17 + 0.17 * curl}};
            std::vector<Vec3> points;
            for (const auto& p : profile) points.push_back({p[0] * std::sin(a), p[1], p[0] * std::cos(a)});
            all.emplace_back(points, std::vector<double>{0.15, 0.14, 0.122, 0.103, 0.083, 0.066, 0.052}, 24);
        }
        return all;
    }();
    return arms[index];
}

double arms(const Vec3& p) {
    if (p.y() > 0.8) return p.y() - 0.6;  // high above them all
    double d = 1e9;
    const double around = std::atan2(p.x(), p.z()), out = p.x() * p.x() + p.z() * p.z();
    for (int i = 0; i < kArms; ++i) {
        double off = std::abs(around - azimuth(i));
        off = std::min(off, 2 * M_PI - off);
        if (off < 0.5 || out < 0.04) d = d > 1e8 ? arm(i).nearest(p).distance : blend(d, arm(i).nearest(p).distance, 0.05);
    }
    return d;
}

const Vec3 kMantle(0, 0.95, -0.06);
const Vec3 kEye(0.195, 0.66, 0.335);  // its mirror image in x too

double eyes(const Vec3& p) { return sphere(Vec3(std::abs(p.x()), p.y(), p.z()), kEye, 0.125); }

double shape(const Vec3& p) {
    double d = ellipsoid(p, kMantle, {0.48, 0.50, 0.47});
    d = blend(d, ellipsoid(p, {0, 0.47, 0}, {0.36, 0.27, 0.36}), 0.22);
    d = blend(d, arms(p), 0.07);
    return blend(d, eyes(p), 0.05);
}

double rootLight(const Vec3& p) { return 0.55 * cover(p.y() - 0.42, 0.5); }

Vec3 paint(int element, const Vec3& p, const Vec3& n, double texel) {
    const Vec3 coral = rgb(0xf0705a), light = rgb(0xffb49a), deep = rgb(0xd2475a), cream = rgb(0xffe9d6);
    const double soft = 1.5 * texel;
    if (element == 0) {
        Vec3 c = mix(coral, deep, std::clamp((p.y() - 0.75) / 0.7, 0.0, 1.0) * 0.65);
        c = mix(c, light, rootLight(p));
        // Freckles on the mantle: fixed places, all around but the face.
        const double spots[][3] = {{-1.9, 1.20, .070}, {-2.6, 1.02, .055}, {2.4, 1.17, .075}, {1.75, 1.00, .050}, {3.0, 0.83, .060}, {-1.35, 0.93, .045},
                                   {0.95, 1.27, .055}, {-0.70, 1.31, .045}, {-2.9, 1.32, .050}, {1.3, 0.80, .035}, {-2.1, 0.78, .045}, {2.2, 0.80, .040}, {0.35, 1.38, .035}};
        for (const auto& s : spots) {
            const Vec3 out(std::sin(s[0]) * std::cos((s[1] - 0.95) * 1.6), std::sin((s[1] - 0.95) * 1.6), std::cos(s[0]) * std::cos((s[1] - 0.95) * 1.6));
            const auto q = onPicture(p, kMantle + 0.48 * out, out, Vec3::UnitY());
            if ((p - kMantle).dot(out) > 0.2) c = mix(c, light, 0.75 * cover(q.norm() - s[2], soft));
        }
        const Vec3 out = Vec3(0, 0, 1), up = Vec3::UnitY();
        if (p.z() > 0) {
            for (double side : {-1.0, 1.0}) {
                const Vec3 centre(side * kEye.x(), kEye.y(), kEye.z()), look = Vec3(side * 0.30, 0.10, 0.95).normalized();
                const double white = (p - centre).norm() - 0.135;
                if (white < 0.03) {
                    const auto q = onPicture(p, centre, look, up);
                    c = mix(c, cream, cover(q.norm() - 0.108, soft) * ((p - centre).dot(look) > 0 ? 1.0 : 0.0));
                    if ((p - centre).dot(look) > 0) c = paintEye(c, q, {0.075, 0.088}, texel);
                }
                const auto k = onPicture(p, {side * 0.285, 0.485, 0.28}, Vec3(side * 0.6, 0, 0.8), up);
                c = mix(c, rgb(0xff8a80), 0.7 * cover(ovalDistance(k, {0, 0}, {0.062, 0.042}), 0.04));
            }
            c = mix(c, rgb(0x6e1f2e), smile(onPicture(p, {0, 0.555, 0}, out, up), {0, 0}, 0.058, 1.0, 0.019, texel));
        }
        return c;
    }
    // Arms: a light underside with two rows of suckers, fading to deep tips.
    const int index = (element - 1) / 3;
    const Tube& tube = arm(index);
    const double along = tube.nearest(p).along;
    const Vec3 t = tube.tangent(along), side = Vec3::UnitY().cross(t).normalized(), down = -t.cross(side).normalized();
    const Vec3 r = p - tube.at(along);
    const double under = n.dot(down);
    Vec3 c = mix(coral, deep, 0.65 * std::max(along - 0.45, 0.0) / 0.55);
    const double root = std::clamp((0.46 - along) / 0.16, 0.0, 1.0);  // 1 at the body, whose colour goes on here
    c = mix(c, light, rootLight(p) * root);
    const double pale = cover(0.30 - under, 0.25) * (1 - cover(along - 0.33, 0.11));
    c = mix(c, cream, 0.92 * pale);
    const double length = tube.length(), step = 0.075, s = along * length;
    const double centre = (std::floor(s / step) + 0.5) * step, radius = tube.radius(centre / length);
    const double x = s - centre, y = std::abs(r.dot(side)) - 0.42 * radius;
    if (under > 0.2) {
        const double disc = std::hypot(x, y) - 0.27 * radius;
        c = mix(c, rgb(0xf7a3a0), pale * cover(disc, soft));
        c = mix(c, rgb(0xffcfc4), pale * cover(disc + 0.15 * radius, 2 * soft));
    }
    return c;
}

}  // namespace

CharacterSpec octopus() {
    CharacterSpec c;
    c.name = "octopus";
    c.shape = shape;
    c.paint = paint;
    const double cuts[] = {0.275, 0.52, 0.755};  // along each arm
    std::vector<std::pair<Vec3, double>> rims;   // places of the joints and how far from them triangles stay small
    for (int i = 0; i < kArms; ++i)
        for (double s : cuts) rims.push_back({arm(i).at(s), arm(i).radius(s)});
    c.size = [rims](const Vec3& p) {
        double h = 0.098;
        for (const auto& [centre, r] : rims) h = std::min(h, 0.35 * r + 0.42 * std::max((p - centre).norm() - 1.1 * r, 0.0));
        h = std::min(h, 0.050 + 0.4 * std::max(eyes(p), 0.0));
        for (int i = 0; i < kArms; ++i) h = std::min(h, 0.026 + 0.25 * std::max((p - arm(i).at(1.0)).norm() - 0.05, 0.0));
        return std::max(h, 0.024);
    };
    c.elements.push_back({"body", {0, 0.62, 0}, 0, 1536, Vec3::UnitY(), -Vec3::UnitZ()});
    c.bones.push_back({"mantle-bone", "body", Vec3(0, 0.42, 0), Vec3(0, 1.25, -0.05), ""});
    for (int i = 0; i < kArms; ++i) {
        const std::string name = "arm" + std::to_string(i + 1);
        const Tube& t = arm(i);
        const char* parts[] = {"upper", "middle", "tip"};
        const double ends[] = {cuts[0], cuts[1], cuts[2], 0.97};
        for (int k = 0; k < 3; ++k) {
            const Vec3 from = t.at(ends[k]), to = t.at(ends[k + 1]);
            // The seam of the texture is on top, where the colour is even.
            c.elements.push_back({name + "-" + parts[k], t.at((ends[k] + ends[k + 1]) / 2), 0, 320, (from - to).normalized(), Vec3::UnitY(), k < 2});
            const int element = int(c.elements.size()) - 1;
            c.joints.push_back({k == 0 ? 0 : element - 1, element, from, t.tangent(ends[k]), 18, {11, 5, 1}});
        }
        const std::string upper = name + "-upper", middle = name + "-middle", tip = name + "-tip";
        c.bones.push_back({name + "-root-bone", "body", "mantle-bone/start", "body/" + upper, "mantle-bone"});
        c.bones.push_back({upper + "-bone", upper, name + "-root-bone/end", upper + "/" + middle, name + "-root-bone"});
        c.bones.push_back({middle + "-bone", middle, upper + "-bone/end", middle + "/" + tip, upper + "-bone"});
        c.bones.push_back({tip + "-bone", tip, middle + "-bone/end", t.at(0.985), middle + "-bone"});
    }
    c.pins = {"mantle-bone/start", "mantle-bone/end"};  // pulling an arm does not turn the body over
    c.stretch(0.7, 1.5, "arm");
    c.stretch(0.75, 1.3, "mantle");
    c.stretch(0.9, 1.15, "-root-bone");
    return c;
}

}  // namespace imomushi::samples
