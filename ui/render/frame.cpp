// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace imomushi::render {

namespace {

using Eigen::Matrix4f;
using Eigen::Vector2f;

// The key light: from the left, above and in front, so that the three-quarter view from the right shows light and shade.
const Vec3 kKeyDirection = Vec3(-0.42, 0.86, 0.52).normalized();
// Radius of the shadow's penumbra relative to the width of the shadow map.
constexpr float kPenumbra = 0.007f;
// How far along its normal a point is moved before it is looked up in the shadow map, in scene radii: more than the facets of a coarse mesh lie
// beside the smooth surface they stand for, less than anything that casts a shadow of its own.
constexpr double kShadowOffset = 0.009;
// How far the shadow map reaches along the light, in scene radii behind the centre: the ground below a raised character.
constexpr double kShadowDepth = 3.0;

Matrix4f orthographic(const Vec3& centre, const Vec3& towardsLight, const Vec3& up, double halfWidth, double before, double behind) {
    const Vec3 back = towardsLight.normalized(), right = up.cross(back).normalized(), above = back.cross(right);
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.block<1, 3>(0, 0) = right.transpose() / halfWidth;
    m.block<1, 3>(1, 0) = above.transpose() / halfWidth;
    m.block<1, 3>(2, 0) = -2.0 / (before + behind) * back.transpose();
    m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * centre;
    m(2, 3) += (before - behind) / (before + behind);
    return m.cast<float>();
}

}  // namespace

void Frame::set(const Scene& scene, const std::vector<GpuBody*>& drawn, int width, int height) {
    Eigen::AlignedBox3d box;
    for (const GpuBody* gpu : drawn)
        if (gpu) box.extend(gpu->tightBounds);
    if (box.isEmpty())
        for (const Marker& m : scene.markers) box.extend(m.from);
    if (box.isEmpty()) box = Eigen::AlignedBox3d(Vec3(-1, scene.ground, -1), Vec3(1, scene.ground + 1, 1));
    centre = box.center();
    radius = std::max(0.5 * box.diagonal().norm(), 1e-6);

    const Camera& camera = scene.camera;
    const double distance = (camera.eye - camera.target).norm();
    const double reach = camera.orthographic ? camera.orthoHeight : distance;
    const double fadeRadius = 5.0 * radius + 2.5 * reach;
    const Eigen::Matrix4d view = camera.view();
    const double aspect = static_cast<double>(width) / height;
    double extent = radius;  // of the sphere that holds all, markers too
    for (const GpuBody* gpu : drawn)
        if (gpu && gpu->surface >= 0) extent = std::max(extent, (gpu->high.cast<double>() - centre).cwiseMax(centre - gpu->low.cast<double>()).norm());
    const double slope = camera.orthographic ? 0.0 : 2.0 * std::tan(0.5 * camera.fov) / height, flat = camera.orthographic ? camera.orthoHeight / height : 0.0;
    const auto reachOf = [&](const Marker& m) { return m.shape == Marker::Shape::Gizmo ? GizmoSizes::kReach * scene.unit() * (flat + slope * (m.from - camera.eye).norm()) : 0.0; };
    for (const Marker& m : scene.markers) extent = std::max({extent, (m.from - centre).norm() * 1.2 + reachOf(m), (m.to - centre).norm() * 1.2});
    const Eigen::Matrix4d projection = camera.projection(aspect, centre, extent);

    FrameBlock& b = block;
    b.view = view.cast<float>();
    b.viewProjection = (projection * view).cast<float>();
    // The light's up axis: anything but its own direction.
    b.shadow = orthographic(centre, kKeyDirection, Vec3::UnitZ(), radius * 1.02, radius * 1.02, radius * kShadowDepth);
    const Vec3 forward = -view.block<1, 3>(2, 0).transpose();
    b.eye << camera.eye.cast<float>(), camera.orthographic ? 1.0f : 0.0f;
    b.forward << forward.cast<float>(), scene.unit();
    b.keyDirection << kKeyDirection.cast<float>(), kPenumbra;
    b.viewport << static_cast<float>(width), static_cast<float>(height), 1.0f / static_cast<float>(width), 1.0f / static_cast<float>(height);
    b.sphere << centre.cast<float>(), static_cast<float>(radius);
    b.ground << static_cast<float>(scene.ground), scene.grid ? 1.0f : 0.0f, scene.groundShadow ? 1.0f : 0.0f, scene.darkTheme ? 1.0f : 0.0f;
    // The shadow of the highest point falls this far beside the character.
    const double top = std::max(centre.y() + radius - scene.ground, 0.0);
    const double cast = std::min(top / kKeyDirection.y(), 3.0 * radius);
    const Vec3 middle = centre - 0.5 * cast * kKeyDirection;
    b.patchArea << static_cast<float>(middle.x()), static_cast<float>(middle.z()), static_cast<float>(1.25 * radius + 0.5 * cast), static_cast<float>(0.35 * radius);
    heightTransform = orthographic(Vec3(middle.x(), scene.ground, middle.z()), -Vec3::UnitY(), Vec3::UnitZ(), 1.25 * radius + 0.5 * cast,
                                    radius * 2.0, b.patchArea.w());
    const double decade = std::log10(std::max(reach * 0.5, 1e-6));
    const double whole = std::floor(decade), fine = std::pow(10.0, whole - 1.0);
    b.lines << static_cast<float>(fine), static_cast<float>(10.0 * fine), static_cast<float>(decade - whole), static_cast<float>(fadeRadius);
    const double h = camera.orthographic ? 0.5 * camera.orthoHeight : std::tan(0.5 * camera.fov);
    b.projection << static_cast<float>(h * aspect), static_cast<float>(h), static_cast<float>(kShadowOffset * radius), 0.0f;

    b.right << view.block<1, 3>(0, 0).transpose().cast<float>(), scene.solidGround ? 1.0f : 0.0f;
    b.above << view.block<1, 3>(1, 0).transpose().cast<float>(), 0.0f;

    content.setEmpty();
    const auto cover = [&](const Vec3& low, const Vec3& high, double pixels) {
        for (int k = 0; k < 8; ++k) {
            const Vec3 p((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
            const Eigen::Vector4d c = projection * view * p.homogeneous();
            if (c.w() < 1e-3 * radius && !camera.orthographic) {
                content = Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Ones());
                return;
            }
            const Eigen::Vector2d s = c.head<2>() / c.w() * 0.5 + Eigen::Vector2d(0.5, 0.5), margin(pixels / width, pixels / height);
            content.extend((s - margin).cast<float>());
            content.extend((s + margin).cast<float>());
        }
    };
    frontToBack.clear();
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (!drawn[i]) continue;
        cover(drawn[i]->low.cast<double>(), drawn[i]->high.cast<double>(), 1.0);
        frontToBack.push_back(i);
    }
    const auto near = [&](std::size_t i) { return forward.cast<float>().dot(drawn[i]->low + drawn[i]->high); };
    std::sort(frontToBack.begin(), frontToBack.end(), [&](std::size_t i, std::size_t j) { return std::pair(near(i), i) < std::pair(near(j), j); });
    for (const Marker& m : scene.markers) {
        const double length = (m.to - m.from).norm();
        const Vec3 r = Vec3::Constant(m.shape == Marker::Shape::Bone ? 0.1 * length : m.shape == Marker::Shape::PlaneGizmo ? 1.5 * length : 0.0);
        const double pixels = (m.shape == Marker::Shape::Gizmo ? GizmoSizes::kReach : 24.0) * scene.unit();
        if (m.shape == Marker::Shape::FaceOutline)
            for (const Vec3& p : m.outline) cover(p, p, pixels);
        else if (m.shape == Marker::Shape::Bone || m.shape == Marker::Shape::PlaneGizmo || m.shape == Marker::Shape::Axis)
            cover(m.from.cwiseMin(m.to) - r, m.from.cwiseMax(m.to) + r, pixels);
        else
            cover(m.from, m.from, pixels);
    }
    content = content.intersection(Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Ones()));
    if (content.isEmpty()) content = Eigen::AlignedBox2f(Vector2f::Zero(), Vector2f::Zero());
}

}  // namespace imomushi::render
