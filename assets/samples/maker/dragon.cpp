// SPDX-License-Identifier: GPL-3.0-or-later
// A baby dragon in one piece, with eyes, horns, wings and a tongue of their own. It looks along +z and stands on y = 0; its left is +x.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "character.h"
#include "rigged.h"
#include "surface.h"

namespace imomushi::samples {

namespace {

Vec3 mirrored(const Vec3& p) { return {std::abs(p.x()), p.y(), p.z()}; }

const Vec3 kSkull(0, 1.36, 0.03);
const Vec3 kEye(0.195, 1.425, 0.285);
constexpr double kEyeRadius = 0.118;
const Vec3 kLook = Vec3(0.28, 0.06, 1).normalized();
const Vec3 kShoulderPoint(0.24, 0.85, 0.04), kWrist(0.58, 0.775, 0.17), kHand(0.645, 0.76, 0.20);
const Vec3 kHip(0.21, 0.34, 0.02), kAnkle(0.245, 0.13, 0.06), kFoot(0.26, 0.088, 0.15);
const Vec3 kShoulder = kShoulderPoint + 0.32 * (kWrist - kShoulderPoint), kThigh(0.225, 0.26, 0.03);  // joints
const Vec3 kHornFoot(0.17, 1.66, -0.02), kHornTip(0.27, 1.90, -0.13);

const Tube& tail() {
    static const Tube tube({{0, 0.52, -0.10}, {0, 0.30, -0.46}, {0, 0.20, -0.80}, {0, 0.33, -1.08}, {0, 0.54, -1.16}}, {0.20, 0.155, 0.115, 0.08, 0.05}, 40);
    return tube;
}

// Fields of the limbs: what they are blended from, and what the weights come from.
double trunkField(const Vec3& p) {
    const double belly = ellipsoid(p, {0, 0.62, 0.02}, {0.345, 0.33, 0.31});
    return blend(belly, taperedCapsule(p, {0, 0.80, 0.01}, {0, 1.10, 0.02}, 0.24, 0.185), 0.16);
}
double snout(const Vec3& p) { return ellipsoid(p, {0, 1.255, 0.33}, {0.255, 0.165, 0.19}); }
double headField(const Vec3& p) {
    const Vec3 q = mirrored(p);
    double d = blend(ellipsoid(p, kSkull, {0.425, 0.36, 0.36}), snout(p), 0.14);
    return blend(d, sphere(q, {0.085, 1.372, 0.455}, 0.038), 0.06);
}
double armField(const Vec3& q) { return blend(taperedCapsule(q, kShoulderPoint, kWrist, 0.112, 0.085), ellipsoid(q, kHand, {0.105, 0.09, 0.10}), 0.05); }
double legField(const Vec3& q) { return blend(taperedCapsule(q, kHip, kAnkle, 0.175, 0.14), ellipsoid(q, kFoot, {0.15, 0.088, 0.215}), 0.07); }
double tailField(const Vec3& p) { return blend(tail().nearest(p).distance, ellipsoid(p, tail().at(1.0) + Vec3(0, 0.05, -0.01), {0.05, 0.095, 0.085}), 0.05); }

/// A row of rounded spikes from the back of the head to the tail: foot and tip of each.
const std::vector<std::pair<Vec3, Vec3>>& spikeRow() {
    static const std::vector<std::pair<Vec3, Vec3>> row = [] {
        std::vector<std::pair<Vec3, Vec3>> all = {{{0, 1.68, -0.10}, {0, 1.80, -0.17}}, {{0, 1.50, -0.29}, {0, 1.60, -0.42}}, {{0, 1.24, -0.28}, {0, 1.29, -0.41}},
                                                  {{0, 0.97, -0.19}, {0, 1.01, -0.33}}, {{0, 0.70, -0.27}, {0, 0.76, -0.42}}};
        for (double s : {0.36, 0.58, 0.78}) {
            const Vec3 t = tail().tangent(s), up(0, -t.z(), t.y());
            const double r = tail().radius(s);
            all.push_back({tail().at(s) + 0.8 * r * up, tail().at(s) + (r + 0.085 - 0.03 * s) * up - 0.03 * Vec3::UnitZ()});
        }
        return all;
    }();
    return row;
}
double spike(const Vec3& p, const std::pair<Vec3, Vec3>& one) { return taperedCapsule(p, one.first, one.second, 0.062, 0.028); }
double spikes(const Vec3& p) {
    double d = 1e9;
    for (const auto& one : spikeRow()) d = std::min(d, spike(p, one));
    return d;
}

/// The mouth: a smiling hollow in the snout.
double mouth(const Vec3& p) {
    const Vec3 bent = p - Vec3(0, 1.3 * p.x() * p.x(), 0);
    return ellipsoid(bent, {0, 1.185, 0.47}, {0.155, 0.052, 0.20});
}

double bodyShape(const Vec3& p) {
    const Vec3 q = mirrored(p);
    double d = blend(trunkField(p), headField(p), 0.07);
    d = blend(d, armField(q), 0.07);
    d = blend(d, legField(q), 0.07);
    d = blend(d, tailField(p), 0.10);
    // Eyelids: a thicker ball around the upper and rear half of the eye.
    const double lid = -blend(-sphere(q, kEye, kEyeRadius + 0.022), -((q - kEye).dot(Vec3(0.1, -0.62, 0.78)) - 0.012), 0.02);
    d = blend(d, lid, 0.035);
    d = blend(d, spikes(p), 0.03);
    d = -blend(-d, mouth(p), 0.02);
    // Nostrils.
    return -blend(-d, sphere(q, {0.088, 1.378, 0.497}, 0.017), 0.012);
}

// A wing in its own plane: along the arm, up, and across.
struct WingFrame {
    Vec3 origin, along = Vec3(0.85, 0.14, -0.50).normalized(), up, across;
    WingFrame() {
        // A hair off the back, so that the thin wings are no flesh.
        origin = project(bodyShape, {0.10, 0.86, -0.21});
        origin += 0.005 * normal(bodyShape, origin);
        across = along.cross(Vec3(0.0, 0.9, -0.1)).normalized();
        up = across.cross(along);
    }
    [[nodiscard]] Vec3 local(const Vec3& p) const { return {(p - origin).dot(along), (p - origin).dot(up), (p - origin).dot(across)}; }
};
const WingFrame& wingFrame() {
    static const WingFrame frame;
    return frame;
}

constexpr int kFan = 24, kRings = 5;             // of the wing's grid: around its root, and outwards
constexpr double kFanFrom = 0.95, kFanTo = -0.80;  // radians in its plane

constexpr double kWingThickness = 0.03;             // m, each side

/// How far the wing reaches: three fingers, hollows between them.
double wingReach(double angle) {
    const double s = (kFanFrom - angle) / (kFanFrom - kFanTo);
    return (0.60 - 0.18 * s) * (1.0 - 0.24 * std::abs(std::sin(3 * M_PI * s)));
}

double wingHollow(const Vec3& l) { return 0.30 * l.x() * l.x() - 0.4 * l.y() * l.y(); }
double wingSheet(const Vec3& p) {
    const Vec3 l = wingFrame().local(mirrored(p));
    return l.z() - wingHollow(l);
}

/// A closed lens: two sheets that share their rim.
Mesh wingMesh() {
    Mesh mesh;
    const WingFrame& f = wingFrame();
    int at[2][kFan + 1][kRings + 1];
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i <= kFan; ++i)
            for (int k = 0; k <= kRings; ++k) {
                if (k == 0 && i > 0) {
                    at[side][i][0] = at[side][0][0];
                    continue;
                }
                if (side == 1 && (k == 0 || k == kRings || i == 0 || i == kFan)) {
                    at[1][i][k] = at[0][i][k];
                    continue;
                }
                const double s = double(i) / kFan, r = double(k) / kRings, angle = kFanFrom + s * (kFanTo - kFanFrom), reach = r * wingReach(angle);
                Vec3 l(reach * std::cos(angle), reach * std::sin(angle), 0);
                const double thick = kWingThickness * std::sqrt(4 * s * (1 - s) * r * (1 - r));
                l.z() = wingHollow(l) + (side == 0 ? thick : -thick);
                at[side][i][k] = int(mesh.points.size());
                mesh.points.push_back(f.origin + l.x() * f.along + l.y() * f.up + l.z() * f.across);
            }
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < kFan; ++i)
            for (int k = 0; k < kRings; ++k) {
                const auto add = [&](int a, int b, int c) {
                    if (a == b || b == c || c == a) return;  // at the root
                    if (side == 0) std::swap(b, c);
                    mesh.triangles.push_back({a, b, c});
                };
                const int a = at[side][i][k], b = at[side][i][k + 1], c = at[side][i + 1][k + 1], d = at[side][i + 1][k];
                if (i < kFan / 2) {  // no triangle has all its corners on the rim: both sheets would have it
                    add(a, b, d);
                    add(b, c, d);
                } else {
                    add(a, b, c);
                    add(a, c, d);
                }
            }
    return mesh;
}

double hornShape(const Vec3& p) {
    const Vec3 q = mirrored(p);
    static const Tube horn({kHornFoot, {0.235, 1.79, -0.045}, kHornTip}, {0.072, 0.055, 0.026}, 12);
    return horn.nearest(q).distance;
}

double tongueShape(const Vec3& p) { return ellipsoid(p, {0, 1.155, 0.385}, {0.088, 0.030, 0.105}); }
double toothShape(const Vec3& p) { return taperedCapsule(mirrored(p), {0.078, 1.252, 0.480}, {0.080, 1.208, 0.492}, 0.019, 0.008); }
double eyeShape(const Vec3& p) { return sphere(mirrored(p), kEye, kEyeRadius); }

Vec3 paintBody(const Vec3& p, const Vec3& n, double texel) {
    const Vec3 q = mirrored(p);
    Vec3 c = mix(rgb(0x3fa79a), rgb(0x7fd3a8), std::clamp(0.25 + 0.55 * n.y() + 0.25 * n.z(), 0.0, 1.0));
    c = mix(c, rgb(0x2f7f8f), 0.45 * cover(n.z() + 0.55, 0.9));
    // Round spots on the back, the head and the thighs.
    for (const auto& [centre, r] : {std::pair{Vec3(0.24, 0.86, -0.22), 0.055}, {Vec3(0.30, 0.66, -0.14), 0.045}, {Vec3(0.16, 0.62, -0.30), 0.04}, {Vec3(0.30, 1.58, -0.14), 0.06},
                                    {Vec3(0.40, 1.42, -0.10), 0.042}, {Vec3(0.22, 1.40, -0.30), 0.055}, {Vec3(0.36, 0.42, 0.04), 0.05}, {Vec3(0.16, 0.40, -0.34), 0.05},
                                    {Vec3(0.14, 0.31, -0.56), 0.042}, {Vec3(0.10, 0.24, -0.82), 0.034}, {Vec3(0.14, 1.66, 0.20), 0.03}, {Vec3(0.20, 1.645, 0.13), 0.022}})
        c = mix(c, rgb(0x2c8a86), 0.75 * cover((q - centre).norm() - r, 0.03));
    // The belly, cream, with soft bands; and the chin.
    const double under = ovalDistance({p.x(), p.y()}, {0, 0.65}, {0.235, 0.32});
    if (n.z() > 0.05 && p.z() > 0.05 && p.y() < 1.06) {
        const double band = std::abs(std::remainder(p.y() - 0.5 * p.x() * p.x(), 0.105));
        const Vec3 cream = mix(rgb(0xffedc4), rgb(0xf3cf95), 0.8 * cover(band - 0.008, 0.018));
        c = mix(c, cream, cover(under, 0.03));
    }
    c = mix(c, rgb(0xd9f0c0), 0.85 * cover(snout(p) - 0.012, 0.05) * cover(p.y() - 1.30, 0.10));
    // Under the tail.
    if (p.z() < -0.2) c = mix(c, rgb(0xf7deaa), 0.85 * cover(n.y() + 0.62, 0.25));
    const Vec3 cheek(0.335, 1.235, 0.27);
    c = mix(c, rgb(0xff8d86), 0.8 * cover((q - cheek).norm() - 0.062, 0.06));
    // Eyelids, a little deeper, with a light rim.
    c = mix(c, rgb(0x2f8d8a), 0.55 * cover(sphere(q, kEye, kEyeRadius + 0.026), 0.02));
    // Spikes and the tail's tip: warm orange.
    c = mix(c, rgb(0xf6a047), cover(spikes(p) - 0.012, 0.014));
    c = mix(c, rgb(0xf59a43), cover(ellipsoid(p, tail().at(1.0) + Vec3(0, 0.05, -0.01), {0.05, 0.095, 0.085}) - 0.008, 0.02));
    // Claws: three on each foot and hand.
    for (double x : {0.175, 0.262, 0.348}) c = mix(c, rgb(0xfff1d2), cover(ellipsoid(q, {x, 0.055, 0.335 - 0.9 * std::abs(x - 0.262) * 0.35}, {0.03, 0.035, 0.05}), 0.5 * 0.012 + texel));
    for (double y : {-0.05, 0.0, 0.05}) c = mix(c, rgb(0xfff1d2), cover(sphere(q, kHand + Vec3(0.085 - 0.3 * std::abs(y), y * 0.9 - 0.03, 0.055), 0.022), 0.5 * 0.012 + texel));
    // Nostrils, and the inside of the mouth.
    c = mix(c, rgb(0x24605f), cover(sphere(q, {0.088, 1.378, 0.497}, 0.021), 0.008));
    c = mix(c, mix(rgb(0xb4454f), rgb(0x5a1c2e), std::clamp((0.50 - p.z()) / 0.16, 0.0, 1.0)), cover(mouth(p) - 0.004, 0.008));
    return c;
}

Vec3 paintBall(const Vec3& p, const Vec3&, double texel) {
    const double side = p.x() < 0 ? -1 : 1;
    const Vec3 look(side * kLook.x(), kLook.y(), kLook.z()), centre(side * kEye.x(), kEye.y(), kEye.z());
    if ((p - centre).dot(look) < 0) return rgb(0xfffaf2);
    const auto q = onPicture(p, centre, look, Vec3::UnitY());
    const double r = q.norm(), soft = 1.5 * texel;
    Vec3 c = mix(rgb(0xfffdf8), rgb(0xe9dcd0), cover(-q.y() + 0.05, 0.12));
    const double lower = std::clamp(0.5 - q.y() / 0.14, 0.0, 1.0);
    c = mix(c, rgb(0x7a3b16), cover(r - 0.083, soft + 0.004));
    c = mix(c, mix(rgb(0xc9661a), rgb(0xffc93f), lower), cover(r - 0.076, soft + 0.006));
    c = mix(c, rgb(0x2a1712), cover(ovalDistance(q, {0, 0}, {0.047, 0.056}), soft + 0.003));
    c = mix(c, Vec3::Ones(), cover((q - Eigen::Vector2d(-0.028, 0.034)).norm() - 0.021, soft));
    return mix(c, Vec3::Ones(), 0.9 * cover((q - Eigen::Vector2d(0.030, -0.030)).norm() - 0.010, soft));
}

Vec3 paintWing(const Vec3& p, const Vec3&, double) {
    const Vec3 l = wingFrame().local(mirrored(p));
    const double r = std::hypot(l.x(), l.y()), angle = std::atan2(l.y(), l.x()), s = (kFanFrom - angle) / (kFanFrom - kFanTo);
    const Vec3 skin = mix(rgb(0xffc078), rgb(0xf0665c), std::clamp(r / 0.45, 0.0, 1.0));
    const double finger = r * std::abs(std::remainder(s, 1.0 / 3)) * (kFanFrom - kFanTo);  // m to the nearest of four
    return mix(mix(skin, rgb(0x3fa79a), cover(finger - 0.016, 0.012)), rgb(0x3fa79a), cover(r - 0.05, 0.03));
}

Vec3 paintHorn(const Vec3& p, const Vec3&, double) {
    const double s = (mirrored(p) - kHornFoot).dot((kHornTip - kHornFoot).normalized());
    const Vec3 c = mix(rgb(0xfff0cf), rgb(0xe79a4a), std::clamp(s / 0.27, 0.0, 1.0));
    return mix(c, rgb(0xd9a066), 0.5 * cover(std::abs(std::remainder(s, 0.075)) - 0.006, 0.014));
}

Vec3 paintTongue(const Vec3& p, const Vec3&, double) { return mix(rgb(0xff8a92), rgb(0xd9566a), cover(std::abs(p.x()) - 0.008, 0.02)); }

Vec3 paintTooth(const Vec3& p, const Vec3&, double) { return mix(rgb(0xfffdf2), rgb(0xf2e3c4), cover(1.235 - p.y(), 0.03)); }

enum Joint { kRoot, kSpine, kHead, kArmL, kHandL, kArmR, kHandR, kLegL, kFootL, kLegR, kFootR, kTail1, kTail2, kTail3, kWingL, kWingR, kJoints };

std::vector<double> bodyWeights(const Vec3& p) {
    std::vector<double> w(kJoints, 0.0);
    const auto put = [&](int joint, double field, double width) { w[joint] = std::exp(-std::clamp(field, -0.2, 2.0) / width); };
    const Vec3 left(p.x(), p.y(), p.z()), right(-p.x(), p.y(), p.z());
    const double hips = cover(p.y() - 0.56, 0.30), t = tail().nearest(p).along;
    const double trunk = std::exp(-std::clamp(trunkField(p), -0.05, 2.0) / 0.03);
    w[kRoot] = trunk * hips;
    w[kSpine] = trunk * (1 - hips);
    put(kHead, std::max(headField(p), 1.03 - p.y()), 0.03);
    for (const auto& [q, arm, hand, leg, foot] : {std::tuple{left, kArmL, kHandL, kLegL, kFootL}, {right, kArmR, kHandR, kLegR, kFootR}}) {
        if (q.x() < 0) continue;
        const double a = std::exp(-std::clamp(std::max(armField(q), 0.31 - q.x()), -0.2, 2.0) / 0.03), h = cover(0.50 - q.x(), 0.10);
        w[arm] = a * (1 - h);
        w[hand] = a * h;
        const double l = std::exp(-std::clamp(std::max(legField(q), q.y() - 0.30), -0.2, 2.0) / 0.03), f = cover(q.y() - 0.15, 0.08);
        w[leg] = l * (1 - f);
        w[foot] = l * f;
    }
    const double any = std::exp(-std::clamp(std::max(tailField(p), 0.30 + p.z()), -0.2, 2.0) / 0.03);
    const double b = cover(0.42 - t, 0.14), c = cover(0.72 - t, 0.14);
    w[kTail1] = any * (1 - b);
    w[kTail2] = any * b * (1 - c);
    w[kTail3] = any * b * c;
    return w;
}

std::vector<double> only(int joint) {
    std::vector<double> w(kJoints, 0.0);
    w[joint] = 1;
    return w;
}

/// Two halves of a ball around `centre`, each unrolled from its middle: distances from the middle are kept.
void addBall(std::vector<Chart>& charts, const std::function<bool(const Vec3&)>& holds, const Vec3& centre, const Vec3& out) {
    for (double sign : {1.0, -1.0}) {
        const Vec3 axis = sign * out;
        charts.push_back({[=](const Vec3& p, const Vec3&) { return holds(p) && (p - centre).dot(axis) >= 0; },
                          [=](const Vec3& p) {
                              const Vec3 d = p - centre;
                              const auto flat = onPicture(p, centre, axis, std::abs(axis.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ());
                              return Eigen::Vector2d(flat * (flat.norm() > 1e-9 ? std::atan2(flat.norm(), d.dot(axis)) * d.norm() / flat.norm() : 1.0));
                          }});
    }
}

/// Two halves of a limb along a segment, unrolled from the lines in its front and back.
void addLimb(std::vector<Chart>& charts, const std::function<bool(const Vec3&)>& holds, const Vec3& from, const Vec3& to, const Vec3& front) {
    const Vec3 axis = (to - from).normalized(), f = (front - axis * front.dot(axis)).normalized(), side = axis.cross(f);
    for (double sign : {1.0, -1.0})
        charts.push_back({[=](const Vec3& p, const Vec3&) { return holds(p) && sign * (p - from).dot(f) >= 0; },
                          [=](const Vec3& p) {
                              const Vec3 d = p - from;
                              const double a = sign * d.dot(f), b = sign * d.dot(side);
                              return Eigen::Vector2d(std::atan2(b, a) * std::hypot(a, b), d.dot(axis));
                          }});
}

Mesh ball(const Vec3& centre, double radius, int vertices) {
    const Shape shape = [=](const Vec3& p) { return sphere(p, centre, radius); };
    const Vec3 reach = Vec3::Constant(1.3 * radius);
    return remesh(surfaceOf(shape, centre - reach, centre + reach, 0.3 * radius), 0, shape, [=](const Vec3&) { return 0.25 * radius; }, vertices);
}

/// A small part inside a box; of a mirrored shape its left side, or both.
Mesh partOf(const Shape& shape, const Vec3& low, const Vec3& high, double step, double size, int vertices) {
    return remesh(surfaceOf(shape, low, high, step), 0, shape, [=](const Vec3&) { return size; }, vertices);
}

Mesh mirrorImage(Mesh mesh) {
    for (Vec3& p : mesh.points) p.x() = -p.x();
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

/// Without the triangles that the eyes hide: the sockets are open.
void openSockets(Mesh& mesh) {
    std::erase_if(mesh.triangles, [&](const auto& t) {
        return std::all_of(t.begin(), t.end(), [&](int v) { return eyeShape(mesh.points[v]) < -0.02; });
    });
    std::vector<int> now(mesh.points.size(), -1);
    std::vector<Vec3> kept;
    for (auto& t : mesh.triangles)
        for (int& v : t) {
            if (now[v] < 0) now[v] = int(kept.size()), kept.push_back(mesh.points[v]);
            v = now[v];
        }
    mesh.points = std::move(kept);
}

}  // namespace

void makeDragon(const std::filesystem::path& folder) {
    RiggedCharacter dragon;
    dragon.name = "dragon";
    dragon.shape = bodyShape;

    RiggedPart body{"body", "skin", 0.55};
    const auto size = [](const Vec3& p) {
        const Vec3 q = mirrored(p);
        double h = 0.052;
        h = std::min(h, 0.026 + 0.25 * std::max(std::abs(sphere(q, kEye, kEyeRadius + 0.02)), 0.0));
        h = std::min(h, 0.020 + 0.25 * std::max(mouth(p), 0.0));
        h = std::min(h, 0.022 + 0.25 * std::max(sphere(q, {0.088, 1.378, 0.497}, 0.03), 0.0));
        h = std::min(h, 0.026 + 0.30 * std::max(spikes(p), 0.0));
        return std::min(h, 0.036 + 0.3 * std::max((q - kHand).norm() - 0.1, 0.0));
    };
    body.mesh = remesh(surfaceOf(bodyShape, {-0.85, -0.06, -1.35}, {0.85, 1.95, 0.70}, 0.03), 0, bodyShape, size, 2700);
    openSockets(body.mesh);
    body.shape = bodyShape;
    body.paint = paintBody;
    body.weights = bodyWeights;
    body.morph = "smile";
    body.morphBy = [](const Vec3& p) {  // the corners of the mouth go up and apart, the cheeks swell
        const Vec3 q = mirrored(p);
        const double corner = std::exp(-(q - Vec3(0.15, 1.21, 0.44)).squaredNorm() / (0.07 * 0.07)), cheek = std::exp(-(q - Vec3(0.31, 1.26, 0.27)).squaredNorm() / (0.09 * 0.09));
        const double side = p.x() < 0 ? -1 : 1;
        return Vec3(side * (0.02 * corner + 0.02 * cheek), 0.035 * corner + 0.015 * cheek, 0.01 * cheek);
    };
    // All spikes are of one colour and share their two charts: seen from each side, from their feet.
    for (double side : {1.0, -1.0})
        body.charts.push_back({[=](const Vec3& p, const Vec3&) { return spikes(p) < 0.004 && (p.x() >= 0) == (side > 0); },
                               [](const Vec3& p) {
                                   const auto& row = spikeRow();
                                   const auto near = std::min_element(row.begin(), row.end(), [&](const auto& a, const auto& b) { return spike(p, a) < spike(p, b); });
                                   return Eigen::Vector2d(p.z() - near->first.z(), p.y() - near->first.y());
                               }});
    const auto limb = [](const Vec3& p) {  // 0: trunk, 1: head, 2: arms, 3: legs, 4: tail
        const Vec3 q = mirrored(p);
        if (p.y() > 1.06) return 1;
        if (armField(q) < 0.02 && q.x() > 0.30 && p.y() > 0.45) return 2;
        if (p.y() < 0.30 && p.z() > -0.28) return 3;
        return p.z() < -0.27 && p.y() < 0.72 && q.x() < 0.26 ? 4 : 0;
    };
    for (double side : {1.0, -1.0}) {
        const auto on = [=](int which) { return [=](const Vec3& p) { return limb(p) == which && (p.x() >= 0) == (side > 0); }; };
        const auto at = [=](const Vec3& p) { return Vec3(side * p.x(), p.y(), p.z()); };
        addLimb(body.charts, on(2), at(kShoulderPoint), at(kHand), Vec3::UnitZ());
        addLimb(body.charts, on(3), at({0.225, 0.5, 0.0}), at({0.26, 0.0, 0.16}), Vec3::UnitZ());
        const Vec3 out = side * Vec3::UnitX();
        body.charts.push_back({[=](const Vec3& p, const Vec3&) { return limb(p) == 4 && (p.x() >= 0) == (side > 0); },
                               [=](const Vec3& p) {
                                   const auto near = tail().nearest(p);
                                   const Vec3 c = tail().at(near.along), t = tail().tangent(near.along), up(0, -t.z(), t.y()), d = p - c;
                                   const double a = d.dot(out), b = d.dot(up);
                                   return Eigen::Vector2d(near.along * tail().length() + d.dot(t), std::atan2(b, a) * std::hypot(a, b));
                               }});
    }
    addBall(body.charts, [=](const Vec3& p) { return limb(p) == 1; }, kSkull, Vec3::UnitZ());
    addBall(body.charts, [](const Vec3&) { return true; }, {0, 0.66, 0}, Vec3::UnitZ());
    dragon.parts.push_back(std::move(body));

    RiggedPart tongue{"tongue", "tongue", 0.35};
    tongue.mesh = partOf(tongueShape, {-0.12, 1.10, 0.25}, {0.12, 1.20, 0.55}, 0.014, 0.03, 130);
    tongue.shape = tongueShape;
    tongue.paint = paintTongue;
    tongue.weights = [](const Vec3&) { return only(kHead); };
    addBall(tongue.charts, [](const Vec3&) { return true; }, {0, 1.15, 0.40}, Vec3::UnitY());
    dragon.parts.push_back(std::move(tongue));

    RiggedPart teeth{"teeth", "tooth", 0.25};
    teeth.mesh = partOf(toothShape, {-0.12, 1.18, 0.44}, {0.12, 1.29, 0.53}, 0.008, 0.011, 120);
    teeth.shape = toothShape;
    teeth.paint = paintTooth;
    teeth.weights = [](const Vec3&) { return only(kHead); };
    for (double side : {1.0, -1.0}) addBall(teeth.charts, [=](const Vec3& p) { return p.x() * side > 0; }, {0.079 * side, 1.23, 0.486}, Vec3::UnitZ());
    dragon.parts.push_back(std::move(teeth));

    const Mesh eye = ball(kEye, kEyeRadius, 230);
    const Mesh horn = partOf(hornShape, {0.04, 1.54, -0.25}, {0.40, 2.0, 0.12}, 0.018, 0.024, 240);
    const Mesh wing = wingMesh();
    for (const double side : {1.0, -1.0}) {
        const std::string mark = side > 0 ? ".L" : ".R";
        const auto put = [&](RiggedPart part, const Mesh& mesh, const Shape& shape, const Vec3& centre, const Vec3& out, int joint) {
            part.mesh = side > 0 ? mesh : mirrorImage(mesh);
            part.shape = shape;
            part.weights = [=](const Vec3&) { return only(joint); };
            const auto at = [=](const Vec3& p) { return Vec3(side * p.x(), p.y(), p.z()); };
            addBall(part.charts, [](const Vec3&) { return true; }, at(centre), at(out));
            dragon.parts.push_back(std::move(part));
        };
        RiggedPart eyePart{"eye" + mark, "eye", 0.12}, hornPart{"horn" + mark, "horn", 0.4}, wingPart{"wing" + mark, "wing", 0.55};
        eyePart.paint = paintBall;
        hornPart.paint = paintHorn;
        wingPart.paint = paintWing;
        put(eyePart, eye, eyeShape, kEye, kLook, kHead);
        put(hornPart, horn, hornShape, {0.23, 1.78, -0.05}, Vec3::UnitZ(), kHead);
        wingPart.mesh = side > 0 ? wing : mirrorImage(wing);
        wingPart.shape = [](const Vec3& p) { return std::abs(wingSheet(p)); };
        wingPart.weights = [=](const Vec3&) { return only(side > 0 ? kWingL : kWingR); };
        for (const double face : {1.0, -1.0})
            wingPart.charts.push_back({[=](const Vec3& p, const Vec3&) { return face * wingSheet(p) >= 0; },
                                       [](const Vec3& p) { return Eigen::Vector2d(wingFrame().local(mirrored(p)).head<2>()); }});
        dragon.parts.push_back(std::move(wingPart));
    }

    const auto right = [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); };
    dragon.joints = {{"root", -1, {0, 0.42, 0}},
                     {"spine", kRoot, {0, 0.66, 0.0}},
                     {"head", kSpine, {0, 1.10, 0.02}},
                     {"arm.L", kSpine, kShoulder},
                     {"hand.L", kArmL, kWrist - Vec3(0.04, -0.02, 0.02)},
                     {"arm.R", kSpine, right(kShoulder)},
                     {"hand.R", kArmR, right(kWrist - Vec3(0.04, -0.02, 0.02))},
                     {"leg.L", kRoot, kThigh},
                     {"foot.L", kLegL, kAnkle},
                     {"leg.R", kRoot, right(kThigh)},
                     {"foot.R", kLegR, right(kAnkle)},
                     {"tail.1", kRoot, tail().at(0.22)},
                     {"tail.2", kTail1, tail().at(0.45)},
                     {"tail.3", kTail2, tail().at(0.74)},
                     {"wing.L", kSpine, wingFrame().origin},
                     {"wing.R", kSpine, right(wingFrame().origin)}};
    const Vec3 z = Vec3::UnitZ(), y = Vec3::UnitY(), x = Vec3::UnitX();
    dragon.clips = {{"wave",
                     {{kArmL, z, {0, 0.4f, 0.7f, 1.0f, 1.3f, 1.6f, 2.0f}, {0, 1.1, 0.75, 1.1, 0.75, 1.1, 0}},
                      {kHead, z, {0, 0.5f, 1.5f, 2.0f}, {0, -0.14, -0.14, 0}},
                      {kTail1, y, {0, 0.5f, 1.0f, 1.5f, 2.0f}, {0, 0.3, -0.3, 0.3, 0}}}},
                    {"breathe",
                     {{kSpine, x, {0, 1, 2}, {0, -0.06, 0}}, {kHead, x, {0, 1.1f, 2}, {0, 0.08, 0}}, {kArmL, z, {0, 1, 2}, {0, 0.12, 0}}, {kArmR, z, {0, 1, 2}, {0, -0.12, 0}},
                      {kTail2, y, {0, 0.5f, 1.5f, 2}, {0, 0.2, -0.2, 0}}}}};
    std::filesystem::create_directories(folder / dragon.name);
    writeRiggedGlb(dragon, folder / dragon.name / "dragon.glb");
    std::size_t vertices = 0;
    for (const RiggedPart& part : dragon.parts) vertices += part.mesh.points.size();
    std::printf("dragon: %zu parts, %zu vertices\n", dragon.parts.size(), vertices);
}

}  // namespace imomushi::samples
