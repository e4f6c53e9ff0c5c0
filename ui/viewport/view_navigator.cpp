// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/view_navigator.h"

#include <QPointingDevice>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "ui/viewport/axis_ball.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// Zooming by dragging: this many pixels are a notch of the wheel.
constexpr double kPixelsPerNotch = 12.0;
/// A pinch whose size changes by this (its logarithm) is a notch of the wheel.
constexpr double kPinchPerNotch = 0.128;

}  // namespace

QRectF ViewNavigator::ball() const { return AxisBall::area(camera_.width(), Appearance::instance().scale()); }

bool ViewNavigator::takes(QPointF p, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) const {
    return (button == Qt::LeftButton && AxisBall::contains(ball(), p)) || navigationOf(preset_, button, modifiers) != Navigation::None;
}

bool ViewNavigator::press(QPointF p, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) {
    pointer_ = p;
    if (button == Qt::LeftButton && AxisBall::contains(ball(), p)) {
        ballPressed_ = true;
        ballMoved_ = false;
        return true;
    }
    navigation_ = navigationOf(preset_, button, modifiers);
    button_ = button;
    return navigation_ != Navigation::None;
}

void ViewNavigator::drag(QPointF p) {
    const QPointF d = p - pointer_;
    pointer_ = p;
    if (ballPressed_) {
        ballMoved_ = ballMoved_ || d.manhattanLength() > 2.0;
        if (ballMoved_) camera_.orbit(d.x(), d.y());
        return;
    }
    switch (navigation_) {
        case Navigation::Orbit: camera_.orbit(d.x(), d.y()); break;
        case Navigation::Pan: camera_.pan(d.x(), d.y()); break;
        case Navigation::Zoom: camera_.zoom((d.x() - d.y()) / kPixelsPerNotch, camera_.width() / 2.0, camera_.height() / 2.0); break;
        case Navigation::None: break;
    }
}

std::optional<ViewAxis> ViewNavigator::release(QPointF p, Qt::MouseButton button) {
    if (ballPressed_ && button == Qt::LeftButton) {
        ballPressed_ = false;
        return ballMoved_ ? std::nullopt : AxisBall::hit(camera_.axes(), ball(), p);
    }
    if (button == button_) navigation_ = Navigation::None;
    return std::nullopt;
}

void ViewNavigator::cancel() {
    navigation_ = Navigation::None;
    ballPressed_ = false;
}

bool ViewNavigator::hover(QPointF p, bool enabled) {
    const bool over = enabled && AxisBall::contains(ball(), p);
    const auto hovered = over ? AxisBall::hit(camera_.axes(), ball(), p) : std::nullopt;
    const bool changed = over != overBall_ || hovered != hovered_;
    overBall_ = over;
    hovered_ = hovered;
    return changed;
}

double notchesOf(const QWheelEvent& e) { return (e.angleDelta().y() != 0 ? e.angleDelta().y() : e.angleDelta().x()) / 120.0; }

void ViewNavigator::wheel(const QWheelEvent& e) {
    const bool trackpad = e.device() && e.device()->type() == QInputDevice::DeviceType::TouchPad;
    if (!trackpad || (e.modifiers() & Qt::ControlModifier)) {
        camera_.zoom(notchesOf(e), e.position().x(), e.position().y());
        return;
    }
    const QPointF d = e.pixelDelta().isNull() ? QPointF(e.angleDelta()) / 8.0 : QPointF(e.pixelDelta());
    if (e.modifiers() & Qt::ShiftModifier)
        camera_.pan(d.x(), d.y());
    else
        camera_.orbit(d.x(), d.y());
}

void ViewNavigator::lead(const std::array<QPointF, 2>& from, const std::array<QPointF, 2>& to) {
    const QPointF middle = (to[0] + to[1]) / 2.0, by = middle - (from[0] + from[1]) / 2.0;
    camera_.pan(by.x(), by.y());
    const auto apart = [](const std::array<QPointF, 2>& two) { return std::max(1.0, std::hypot(two[1].x() - two[0].x(), two[1].y() - two[0].y())); };
    pinch(apart(to) / apart(from) - 1.0, middle);
}

void ViewNavigator::pinch(double value, QPointF p) { camera_.zoom(std::log1p(std::max(-0.9, value)) / kPinchPerNotch, p.x(), p.y()); }

void ViewNavigator::paintBall(QPainter& painter, bool dark) const {
    if (camera_.width() > 2.0 * ball().width()) AxisBall::paint(painter, camera_.axes(), ball(), hovered_, overBall_ || ballPressed_, dark);
}

}  // namespace imomushi
