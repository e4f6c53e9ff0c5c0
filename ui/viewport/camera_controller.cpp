// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/camera_controller.h"

#include "core/base/finite.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace imomushi {
namespace {

constexpr double kFov = 0.6;                  ///< radians, vertical
constexpr double kRadiansPerPixel = 0.008;
constexpr double kZoomPerNotch = 0.88;
constexpr double kFramedMargin = 1.12;              ///< room around what is framed
constexpr double kSeconds = 0.22;             ///< of an animated change of view
constexpr double kPole = std::numbers::pi / 2.0;
/// The eye stays within these multiples of the size of what was framed last.
constexpr double kNearest = 1e-3, kFarthest = 1e3;

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

Navigation navigationOf(NavigationPreset preset, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) {
    if (preset == NavigationPreset::Industry && (modifiers & Qt::AltModifier)) {
        if (button == Qt::LeftButton) return Navigation::Orbit;
        if (button == Qt::MiddleButton) return Navigation::Pan;
        if (button == Qt::RightButton) return Navigation::Zoom;
    }
    if (button != Qt::MiddleButton) return Navigation::None;
    if (modifiers & Qt::ShiftModifier) return Navigation::Pan;
    if (modifiers & Qt::ControlModifier) return Navigation::Zoom;
    return Navigation::Orbit;
}

CameraController::CameraController() {
    setDirection(Vec3(-0.55, -0.35, -0.76), false);
    frame({}, false);
}

void CameraController::setViewport(double width, double height) {
    width_ = std::max(1.0, width);
    height_ = std::max(1.0, height);
}

Eigen::Matrix3d CameraController::axesOf(const View& view) {
    const double sy = std::sin(view.yaw), cy = std::cos(view.yaw), sp = std::sin(view.pitch), cp = std::cos(view.pitch);
    Eigen::Matrix3d axes;
    axes.col(0) = Vec3(cy, 0.0, -sy);
    axes.col(2) = Vec3(sy * cp, sp, cy * cp);
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
}

Eigen::Matrix3d CameraController::axes() const { return axesOf(view_); }

double CameraController::halfHeight() const { return view_.distance * std::tan(kFov / 2.0); }

void CameraController::go(const View& view, bool animate) {
    if (!animate) {
        goal_.reset();
        view_ = view;
        return;
    }
    start_ = view_;
    start_.yaw = view.yaw + wrapped(start_.yaw - view.yaw);  // the short way round
    goal_ = view;
    progress_ = 0.0;
}

void CameraController::orbit(double dx, double dy) { turn(-kRadiansPerPixel * dx, kRadiansPerPixel * dy); }

void CameraController::turn(double yaw, double pitch) {
    goal_.reset();
    view_.yaw = wrapped(view_.yaw + yaw);
    view_.pitch = std::clamp(view_.pitch + pitch, -kPole, kPole);
}

void CameraController::pan(double dx, double dy) {
    goal_.reset();
    const double pixel = 2.0 * halfHeight() / height_;
    const Eigen::Matrix3d a = axes();
    view_.target += pixel * (-dx * a.col(0) + dy * a.col(1));
}

void CameraController::zoom(double notches, double x, double y) {
    goal_.reset();
    const double before = view_.distance;
    const double wanted = before * std::pow(kZoomPerNotch, std::clamp(notches, -20.0, 20.0));
    view_.distance = std::clamp(wanted, kNearest * reach_, std::max(before, kFarthest * reach_));
    const double scale = view_.distance / before;
    const double pixel = 2.0 * before * std::tan(kFov / 2.0) / height_;
    const Eigen::Matrix3d a = axes();
    const Vec3 toCursor = pixel * ((x - width_ / 2.0) * a.col(0) - (y - height_ / 2.0) * a.col(1));
    view_.target += (1.0 - scale) * toCursor;
}

void CameraController::setAxis(ViewAxis axis, bool animate) {
    View view = goal_.value_or(view_);
    view.pitch = 0.0;
    switch (axis) {
        case ViewAxis::Front: view.yaw = 0.0; break;
        case ViewAxis::Back: view.yaw = std::numbers::pi; break;
        case ViewAxis::Right: view.yaw = kPole; break;
        case ViewAxis::Left: view.yaw = -kPole; break;
        case ViewAxis::Top:
            view.yaw = 0.0;
            view.pitch = kPole;
            break;
        case ViewAxis::Bottom:
            view.yaw = 0.0;
            view.pitch = -kPole;
            break;
    }
    go(view, animate);
}

void CameraController::setDirection(const Vec3& direction, bool animate) {
    if (!allFinite(direction) || !(direction.norm() > 0.0)) return;
    const Vec3 back = -direction.stableNormalized();
    View view = goal_.value_or(view_);
    view.pitch = std::asin(std::clamp(back.y(), -1.0, 1.0));
    if (std::hypot(back.x(), back.z()) > 1e-9) view.yaw = std::atan2(back.x(), back.z());
    go(view, animate);
}

void CameraController::frame(std::span<const Vec3> points, bool animate) {
    Vec3 low(-0.5, 0.0, -0.5), high(0.5, 1.0, 0.5);
    bool any = false;
    for (const Vec3& p : points) {
        if (!allFinite(p)) continue;
        low = any ? Vec3(low.cwiseMin(p)) : p;
        high = any ? Vec3(high.cwiseMax(p)) : p;
        any = true;
    }
    const Vec3 centre = 0.5 * (low + high);
    // A single point is framed as if it were a tenth of what was framed before.
    const double size = std::max((high - low).norm(), 0.1 * reach_);
    View view = goal_.value_or(view_);
    const Eigen::Matrix3d a = axesOf(view);
    // The tightest eye: for each pair of sides of the view, the eye keeps all points between two planes through it. Without perspective the
    // extents across the view count.
    const double tanY = std::tan(kFov / 2.0) / kFramedMargin, tanX = tanY * width_ / height_;
    const Eigen::Array2d slope(tanX, tanY);
    Eigen::Array2d least = Eigen::Array2d::Constant(1e300), most = -least, narrow = least, wide = most;
    const auto take = [&](const Vec3& p) {
        const Vec3 c = a.transpose() * (p - centre);
        const Eigen::Array2d across = c.head<2>().array();
        least = least.min(across - c.z() * slope);
        most = most.max(across + c.z() * slope);
        narrow = narrow.min(across);
        wide = wide.max(across);
    };
    if (any) {
        for (const Vec3& p : points)
            if (allFinite(p)) take(p);
    } else {
        for (int i = 0; i < 8; ++i) take(Vec3(i & 1 ? low.x() : high.x(), i & 2 ? low.y() : high.y(), i & 4 ? low.z() : high.z()));
    }
    const Eigen::Array2d middle = orthographic_ ? Eigen::Array2d((narrow + wide) / 2.0) : Eigen::Array2d((least + most) / 2.0);
    view.target = centre + middle.x() * a.col(0) + middle.y() * a.col(1);
    // Both projections fit, so that switching between them loses nothing; and the eye stays outside.
    view.distance = std::max({((most - least) / (2.0 * slope)).maxCoeff(), ((wide - narrow) / (2.0 * slope)).maxCoeff(), 0.5 * size});
    if ((high - low).norm() > 0.0) reach_ = size;
    go(view, animate);
}

bool CameraController::advance(double seconds) {
    if (!goal_) return false;
    progress_ += std::max(0.0, seconds) / kSeconds;
    if (progress_ >= 1.0) {
        view_ = *goal_;
        view_.yaw = wrapped(view_.yaw);
        goal_.reset();
        return false;
    }
    const double t = progress_ * progress_ * (3.0 - 2.0 * progress_);
    view_.target = (1.0 - t) * start_.target + t * goal_->target;
    view_.distance = std::pow(start_.distance, 1.0 - t) * std::pow(goal_->distance, t);
    view_.yaw = (1.0 - t) * start_.yaw + t * goal_->yaw;
    view_.pitch = (1.0 - t) * start_.pitch + t * goal_->pitch;
    return true;
}

render::Camera CameraController::camera() const {
    const Eigen::Matrix3d a = axes();
    render::Camera camera;
    camera.target = view_.target;
    camera.eye = view_.target + view_.distance * a.col(2);
    camera.up = a.col(1);
    camera.fov = kFov;
    camera.orthographic = orthographic_;
    camera.orthoHeight = 2.0 * halfHeight();
    return camera;
}

void CameraController::aim(PointerEvent& e) const {
    const Eigen::Matrix3d a = axes();
    const double pixel = 2.0 * std::tan(kFov / 2.0) / height_;
    const Vec3 across = pixel * ((e.x - width_ / 2.0) * a.col(0) - (e.y - height_ / 2.0) * a.col(1));
    e.viewForward = -a.col(2);
    e.viewRight = a.col(0);
    if (orthographic_) {
        // Starts far in front of everything: an orthographic view also shows what lies behind the eye.
        e.rayOrigin = view_.target + view_.distance * across + 10.0 * (view_.distance + reach_ + view_.target.norm()) * a.col(2);
        e.rayDirection = e.viewForward;
        e.pixelAngle = 0.0;
        e.pixelSize = pixel * view_.distance;
    } else {
        e.rayOrigin = view_.target + view_.distance * a.col(2);
        e.rayDirection = (e.viewForward + across).normalized();
        e.pixelAngle = pixel;
        e.pixelSize = 0.0;
    }
}

std::optional<Eigen::Vector2d> CameraController::onScreen(const Vec3& p) const {
    PointerEvent e;
    e.x = width_ / 2.0;
    e.y = height_ / 2.0;
    aim(e);
    return e.onScreen(p);
}

}  // namespace imomushi
