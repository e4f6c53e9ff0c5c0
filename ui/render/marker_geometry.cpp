// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/marker_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/colour.h"
#include "core/base/finite.h"

namespace imomushi::render {

namespace {

using Eigen::Vector3f;
using Eigen::Vector4f;

Vector3f linear(int r, int g, int b) {
    return Vector3f(linearFromSrgb(r / 255.0), linearFromSrgb(g / 255.0), linearFromSrgb(b / 255.0));
}

Vector4f with(const Vector3f& color, float alpha) { return Vector4f(color.x(), color.y(), color.z(), alpha); }

// Radius of a bone at its thickest place, relative to its length; and where that is.
constexpr double kBoneRadius = 0.075, kBoneWaist = 0.16;
// Radii of handles and half widths of lines in logical pixels.
constexpr float kPointRadius = 5.5f, kHandleRadius = 7.5f, kOutlineHalfWidth = 1.1f, kEdgeHalfWidth = 0.6f, kGlow = 5.0f;
// How visible things stay behind bodies: bones live inside, gizmos are tools, the far side of an outline is a hint.
constexpr float kBoneBehind = 0.62f, kOutlineBehind = 0.34f, kPointBehind = 0.85f, kGizmoBehind = 1.0f, kDiscBehind = 0.8f;
// How far beside a shape, in logical pixels, a click still means it.
constexpr double kReach = 4.0;

struct Basis {
    Vec3 along, x, y;
};

Basis basisOf(const Vec3& direction) {
    Basis b;
    b.along = direction.normalized();
    const Vec3 helper = std::abs(b.along.y()) < 0.9 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitX());
    b.x = helper.cross(b.along).normalized();
    b.y = b.along.cross(b.x);
    return b;
}

Vector3f axisColor(const Vec3& direction, Eigen::Index axis = -1) {
    if (axis < 0) direction.cwiseAbs().maxCoeff(&axis);
    return axis == 0 ? linear(226, 88, 88) : axis == 1 ? linear(120, 190, 80) : linear(86, 140, 236);
}

void addTriangle(std::vector<SolidVertex>& out, const Vec3& a, const Vec3& b, const Vec3& c, const Vector4f& color, float behind) {
    const Vector3f n = (b - a).cross(c - a).normalized().cast<float>();
    if (!allFinite(n)) return;
    for (const Vec3& p : {a, b, c}) out.push_back({p.cast<float>(), n, color, behind});
}

void addPolyline(const std::vector<Vec3>& p, bool closed, const Vector4f& color, Vector3f widths, std::vector<LineSegment>& out);

/// `edge`: half width of its edges in drawn pixels; 0: none.
void addBone(const Marker& m, const Vector4f& color, float edge, std::vector<SolidVertex>& out, std::vector<LineSegment>& lines) {
    const Vec3 d = m.to - m.from;
    if (d.norm() < 1e-9) return;
    const Basis b = basisOf(d);
    const double r = kBoneRadius * d.norm();
    const Vec3 waist = m.from + kBoneWaist * d;
    Vec3 ring[4];
    for (int i = 0; i < 4; ++i) {
        const double angle = std::numbers::pi * (0.25 + 0.5 * i);
        ring[i] = waist + r * (std::cos(angle) * b.x + std::sin(angle) * b.y);
    }
    for (int i = 0; i < 4; ++i) {
        addTriangle(out, m.to, ring[i], ring[(i + 1) % 4], color, kBoneBehind);
        addTriangle(out, m.from, ring[(i + 1) % 4], ring[i], color, kBoneBehind);
    }
    if (edge <= 0.0f) return;
    const Vector4f light(0.9f, 0.9f, 0.9f, 0.8f);
    for (const Vec3& corner : ring) addPolyline({m.from, corner, m.to}, false, light, Vector3f(edge, 0.0f, kBoneBehind), lines);
}

void addCone(const Vec3& base, const Vec3& tip, double radius, const Vector4f& color, std::vector<SolidVertex>& out) {
    const Basis b = basisOf(tip - base);
    constexpr int kSides = 16;
    for (int i = 0; i < kSides; ++i) {
        const double s = 2.0 * std::numbers::pi * i / kSides, t = 2.0 * std::numbers::pi * (i + 1) / kSides;
        const Vec3 p = base + radius * (std::cos(s) * b.x + std::sin(s) * b.y), q = base + radius * (std::cos(t) * b.x + std::sin(t) * b.y);
        addTriangle(out, tip, p, q, color, kGizmoBehind);
        addTriangle(out, base, q, p, color, kGizmoBehind);
    }
}

/// The flat region in a closed line, from its middle.
void addDisc(const std::vector<Vec3>& p, const Vector4f& color, float behind, std::vector<SolidVertex>& out) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& q : p) middle += q / static_cast<double>(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3 &a = p[i], &b = p[(i + 1) % p.size()];
        addTriangle(out, middle, a, b, color, behind);
        addTriangle(out, middle, b, a, color, behind);
    }
}

void addPolyline(const std::vector<Vec3>& p, bool closed, const Vector4f& color, Vector3f widths, std::vector<LineSegment>& out) {
    const int n = static_cast<int>(p.size());
    for (int i = 0; i < (closed ? n : n - 1); ++i) {
        const int j = (i + 1) % n;
        const Vec3& before = closed ? p[(i + n - 1) % n] : p[std::max(i - 1, 0)];
        const Vec3& after = closed ? p[(j + 1) % n] : p[std::min(j + 1, n - 1)];
        out.push_back({before.cast<float>(), p[i].cast<float>(), p[j].cast<float>(), after.cast<float>(), color, widths});
    }
}

void addBox(const Vec3& middle, const Eigen::Matrix3d& axes, double half, const Vector4f& color, std::vector<SolidVertex>& out) {
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            const Vec3 n = side * half * axes.col(k), a = half * axes.col((k + 1) % 3), b = side * half * axes.col((k + 2) % 3);
            addTriangle(out, middle + n - a - b, middle + n + a - b, middle + n + a + b, color, kGizmoBehind);
            addTriangle(out, middle + n - a - b, middle + n + a + b, middle + n - a + b, color, kGizmoBehind);
        }
}

/// `metres`: that a pixel of the design covers there.
void addGizmo(const Vec3& at, const GizmoLook& look, const Scene& scene, double metres, MarkerGeometry& out) {
    using Sizes = GizmoSizes;
    const float unit = scene.unit();
    const Camera& camera = scene.camera;
    const Vec3 view = (camera.orthographic ? Vec3(camera.target - camera.eye) : Vec3(at - camera.eye)).normalized();
    const auto color = [&](int axis, GizmoPart part, double alpha) {
        const Vector3f own = axis < 0 ? (scene.darkTheme ? linear(232, 228, 216) : linear(72, 80, 98)) : axisColor(Vec3::Zero(), axis);
        return with(look.hovered == part ? selectionColor() : own, float(alpha));
    };
    const auto wide = [&](GizmoPart part, float half) { return Vector3f((look.hovered == part ? 1.6f : 1.0f) * half * unit, 0.0f, kGizmoBehind); };
    std::vector<Vec3> line;
    if (look.turns) {
        for (int k = 0; k < 3; ++k) {
            const double fade = planeFade(look.axes.col(k), view);
            if (fade <= 0.0) continue;
            const GizmoPart part = partOf(GizmoPart::RingX, k);
            const Vec3 a = look.axes.col((k + 1) % 3), b = look.axes.col((k + 2) % 3);
            // The half that faces the viewer, from one of its ends.
            const double first = std::atan2(b.dot(view), a.dot(view)) + 0.5 * std::numbers::pi;
            line.clear();
            for (int i = 0; i <= Sizes::kSides / 2; ++i) {
                const double angle = first + 2.0 * std::numbers::pi * i / Sizes::kSides;
                line.push_back(at + metres * Sizes::kRing * (std::cos(angle) * a + std::sin(angle) * b));
            }
            addPolyline(line, false, color(k, part, 0.9 * fade), wide(part, 1.4f), out.lines);
        }
        const Basis b = basisOf(view);
        line.clear();
        for (int i = 0; i < Sizes::kSides; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / Sizes::kSides;
            line.push_back(at + metres * Sizes::kRingView * (std::cos(angle) * b.x + std::sin(angle) * b.y));
        }
        addPolyline(line, true, color(-1, GizmoPart::RingView, 0.6), wide(GizmoPart::RingView, 1.0f), out.lines);
    }
    for (int k = 0; k < 3; ++k) {
        const Vec3 axis = look.axes.col(k);
        if (const double fade = axisFade(axis, view); fade > 0.0) {
            const GizmoPart part = partOf(GizmoPart::AxisX, k);
            const GizmoPart scale = partOf(GizmoPart::ScaleX, k), stem = look.moves ? part : scale;
            const Vec3 neck = at + Sizes::kNeck * metres * axis, end = look.moves ? neck : Vec3(at + Sizes::kScale * metres * axis);
            if (look.moves || look.scales) addPolyline({at + Sizes::kStem * metres * axis, end}, false, color(k, stem, fade), wide(stem, 1.5f), out.lines);
            if (look.moves) addCone(neck, at + Sizes::kTip * metres * axis, (look.hovered == part ? 6.5 : 5.5) * metres, color(k, part, fade), out.gizmo);
            if (look.scales) addBox(at + Sizes::kScale * metres * axis, look.axes, (look.hovered == scale ? 1.3 : 1.0) * Sizes::kBox * metres, color(k, scale, fade), out.gizmo);
        }
        if (const double fade = planeFade(axis, view); look.moves && fade > 0.0) {
            const GizmoPart part = partOf(GizmoPart::PlaneX, k);
            std::vector<Vec3> corners;
            for (const Vec3& corner : gizmoPlane(look.axes, k, view)) corners.push_back(at + metres * corner);
            addDisc(corners, color(k, part, (look.hovered == part ? 0.6 : 0.32) * fade), kGizmoBehind, out.sheets);
            addPolyline(corners, true, color(k, part, 0.9 * fade), wide(part, 0.8f), out.lines);
        }
    }
    if (!look.moves) return;
    const bool middle = look.hovered == GizmoPart::Middle;
    out.points.push_back({at.cast<float>(), Vector3f((middle ? 8.5f : 7.0f) * unit, 0.0f, kGizmoBehind), color(-1, GizmoPart::Middle, 1.0)});
}

/// The corners of a gizmo plane.
void planeCorners(const Marker& m, Vec3 (&corner)[4]) {
    const Basis b = basisOf(m.to - m.from);
    const double s = (m.to - m.from).norm();
    corner[0] = m.from + s * (-b.x - b.y);
    corner[1] = m.from + s * (b.x - b.y);
    corner[2] = m.from + s * (b.x + b.y);
    corner[3] = m.from + s * (-b.x + b.y);
}

/// World metres per device pixel at a point.
double metresPerPixel(const Camera& camera, int height, const Vec3& p) {
    if (camera.orthographic) return camera.orthoHeight / height;
    const double depth = std::max((p - camera.eye).dot((camera.target - camera.eye).normalized()), 1e-6);
    return 2.0 * std::tan(0.5 * camera.fov) * depth / height;
}

}  // namespace

Vector3f selectionColor() { return linear(255, 176, 46); }
Vector3f hoverColor() { return linear(150, 208, 255); }

void MarkerGeometry::build(const Scene& scene, int height) {
    bones.clear();
    sheets.clear();
    gizmo.clear();
    lines.clear();
    points.clear();
    const float unit = scene.unit();
    // Handles stand out against the background: light on dark, dark on light.
    const Vector3f ivory = scene.darkTheme ? linear(232, 228, 216) : linear(72, 80, 98), sky = linear(86, 190, 240), green = linear(64, 200, 160), purple = linear(226, 150, 206), vermilion = linear(235, 104, 40);
    for (const Marker& m : scene.markers) {
        const auto colored = [&](const Vector3f& usual) {
            const Vector3f& own = m.refused ? vermilion : usual;
            return m.selected && !m.refused ? selectionColor() : m.hovered ? Vector3f(0.5f * own + 0.5f * hoverColor()) : own;
        };
        const float grow = m.selected || m.hovered ? 1.3f : 1.0f;
        switch (m.shape) {
            case Marker::Shape::Bone:
                // Dark ones on dark flesh are seen by their edges.
                addBone(m, with(colored(ivory), 0.96f), scene.darkTheme ? 0.0f : kEdgeHalfWidth * unit, bones, lines);
                break;
            case Marker::Shape::JointPoint:
                points.push_back({m.from.cast<float>(), Vector3f(kPointRadius * grow * unit, 0.0f, kPointBehind), with(colored(ivory), 1.0f)});
                break;
            case Marker::Shape::HeldPoint:
                points.push_back({m.from.cast<float>(), Vector3f(kHandleRadius * grow * unit, 1.0f, kPointBehind), with(colored(green), 1.0f)});
                break;
            case Marker::Shape::PinnedPoint:
                points.push_back({m.from.cast<float>(), Vector3f(kHandleRadius * grow * unit, 2.0f, kPointBehind), with(colored(purple), 1.0f)});
                break;
            case Marker::Shape::SnapMark:
                points.push_back({m.from.cast<float>(), Vector3f(kHandleRadius * unit, 3.0f, kGizmoBehind), with(selectionColor(), 1.0f)});
                break;
            case Marker::Shape::FaceOutline:
                if (m.outline.size() > 1)
                    addPolyline(m.outline, true, with(colored(sky), 1.0f), Vector3f(kOutlineHalfWidth * grow * unit, kGlow * grow * unit, kOutlineBehind), lines);
                if (m.filled && m.outline.size() > 2) addDisc(m.outline, with(colored(sky), m.selected || m.hovered ? 0.5f : 0.34f), kDiscBehind, sheets);
                break;
            case Marker::Shape::PlaneGizmo: {
                if ((m.to - m.from).norm() < 1e-9) break;
                Vec3 c[4];
                planeCorners(m, c);
                const Vector4f fill = with(colored(sky), 0.22f);
                addTriangle(sheets, c[0], c[1], c[2], fill, kOutlineBehind);
                addTriangle(sheets, c[0], c[2], c[3], fill, kOutlineBehind);
                addTriangle(sheets, c[2], c[1], c[0], fill, kOutlineBehind);
                addTriangle(sheets, c[3], c[2], c[0], fill, kOutlineBehind);
                const Vector3f widths(kOutlineHalfWidth * unit, 0.0f, kGizmoBehind);
                addPolyline({c[0], c[1], c[2], c[3]}, true, with(colored(sky), 0.9f), widths, lines);
                addPolyline({m.from, m.to}, false, with(colored(sky), 1.0f), Vector3f(1.3f * unit, 0.0f, kGizmoBehind), lines);
                const double mpp = metresPerPixel(scene.camera, height, m.to) * unit;
                addCone(m.to - 12.0 * mpp * (m.to - m.from).normalized(), m.to, 4.5 * mpp, with(colored(sky), 1.0f), bones);
                break;
            }
            case Marker::Shape::Gizmo:
                if (m.gizmo) addGizmo(m.from, *m.gizmo, scene, metresPerPixel(scene.camera, height, m.from) * unit, *this);
                break;
            case Marker::Shape::Axis: {
                const Vec3 d = m.to - m.from;
                if (d.norm() < 1e-9) break;
                const double mpp = metresPerPixel(scene.camera, height, m.to) * unit;
                const Vec3 neck = m.to - 13.0 * mpp * d.normalized();
                addPolyline({m.from, neck}, false, with(colored(axisColor(d, m.axis)), 1.0f), Vector3f(1.3f * grow * unit, 0.0f, kGizmoBehind), lines);
                addCone(neck, m.to, 5.0 * grow * mpp, with(colored(axisColor(d, m.axis)), 1.0f), bones);
                break;
            }
        }
    }
}

namespace {

/// World points on the screen.
struct Screen {
    Eigen::Matrix4d view, clip;
    int width, height;

    Screen(const Scene& scene, int w, int h) : view(scene.camera.view()), width(w), height(h) {
        clip = scene.camera.projection(static_cast<double>(w) / h, scene.camera.target, (scene.camera.eye - scene.camera.target).norm() + 1.0) * view;
    }
    /// False: behind the eye.
    bool at(const Vec3& p, Eigen::Vector2d& out) const {
        const Eigen::Vector4d c = clip * p.homogeneous();
        if (c.w() < 1e-9) return false;
        out = Eigen::Vector2d((c.x() / c.w() * 0.5 + 0.5) * width, (0.5 - c.y() / c.w() * 0.5) * height);
        return true;
    }
    [[nodiscard]] double depth(const Vec3& p) const { return -(view.row(2).dot(p.homogeneous())); }
};

/// Distance in pixels from q to the segment a b; `t`: where along it on the screen.
double segmentDistance(const Screen& screen, const Vec3& a, const Vec3& b, const Eigen::Vector2d& q, double& t) {
    Eigen::Vector2d p0, p1;
    t = 0.0;
    if (!screen.at(a, p0) || !screen.at(b, p1)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d d = p1 - p0;
    const double dd = d.squaredNorm();
    t = dd > 0.0 ? std::clamp((q - p0).dot(d) / dd, 0.0, 1.0) : 0.0;
    return (p0 + t * d - q).norm();
}

}  // namespace

int pickMarker(const Scene& scene, int width, int height, double x, double y, double bodyDepth, Vec3& point) {
    const Screen screen(scene, width, height);
    const Eigen::Vector2d q(x, y);
    const double unit = scene.pixelRatio, reach = kReach * unit;
    int best = -1, bestClass = 100;
    double bestDistance = std::numeric_limits<double>::infinity();
    const auto offer = [&](std::size_t i, int rank, double distance, const Vec3& p) {
        if (rank > bestClass || (rank == bestClass && distance >= bestDistance)) return;
        best = static_cast<int>(i), bestClass = rank, bestDistance = distance, point = p;
    };
    for (std::size_t i = 0; i < scene.markers.size(); ++i) {
        const Marker& m = scene.markers[i];
        if (m.id == 0) continue;
        double t = 0.0;
        switch (m.shape) {
            case Marker::Shape::JointPoint:
            case Marker::Shape::HeldPoint:
            case Marker::Shape::PinnedPoint: {
                Eigen::Vector2d p;
                const double radius = (m.shape == Marker::Shape::JointPoint ? kPointRadius : kHandleRadius) * unit + reach;
                if (screen.at(m.from, p) && (p - q).norm() <= radius) offer(i, 0, (p - q).norm(), m.from);
                break;
            }
            case Marker::Shape::SnapMark:
            case Marker::Shape::Gizmo: break;
            case Marker::Shape::Axis: {
                const double d = segmentDistance(screen, m.from, m.to, q, t);
                if (d <= 1.3 * unit + reach) offer(i, 1, d, m.from + t * (m.to - m.from));
                break;
            }
            case Marker::Shape::FaceOutline:
                for (std::size_t k = 0; k < m.outline.size(); ++k) {
                    const Vec3 &a = m.outline[k], &b = m.outline[(k + 1) % m.outline.size()];
                    const double d = segmentDistance(screen, a, b, q, t);
                    const Vec3 p = a + t * (b - a);
                    // The line lies on the surface: what is behind it by more than a line's width of slope is hidden.
                    const double slack = 12.0 * unit * metresPerPixel(scene.camera, height, p);
                    if (d <= kOutlineHalfWidth * unit + reach && screen.depth(p) <= bodyDepth + slack) offer(i, 2, d, p);
                }
                break;
            case Marker::Shape::Bone: {
                const double d = segmentDistance(screen, m.from, m.to, q, t);
                const Vec3 p = m.from + t * (m.to - m.from);
                const double waist = t < kBoneWaist ? t / kBoneWaist : (1.0 - t) / (1.0 - kBoneWaist);
                const double half = kBoneRadius * (m.to - m.from).norm() * waist / metresPerPixel(scene.camera, height, p);
                if (d <= half + 0.75 * reach) offer(i, 3, d, p);
                break;
            }
            case Marker::Shape::PlaneGizmo: {
                Vec3 c[4];
                if ((m.to - m.from).norm() < 1e-9) break;
                planeCorners(m, c);
                Eigen::Vector2d s[4];
                bool all = true;
                for (int k = 0; k < 4; ++k) all = screen.at(c[k], s[k]) && all;
                if (!all) break;
                int left = 0;
                for (int k = 0; k < 4; ++k) {
                    const Eigen::Vector2d e = s[(k + 1) % 4] - s[k], f = q - s[k];
                    left += e.x() * f.y() - e.y() * f.x() > 0.0 ? 1 : -1;
                }
                const double arrow = segmentDistance(screen, m.from, m.to, q, t);
                if (arrow <= 1.3 * unit + reach) offer(i, 1, arrow, m.from + t * (m.to - m.from));
                else if (std::abs(left) == 4) offer(i, 4, 0.0, m.from);
                break;
            }
        }
    }
    return best;
}

}  // namespace imomushi::render
