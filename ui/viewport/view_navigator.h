// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPointF>
#include <array>
#include <optional>

#include "ui/viewport/camera_controller.h"

class QPainter;
class QWheelEvent;

namespace imomushi {

/// Turns the pointer into movements of the camera: drags with the navigation buttons, drags and clicks on the axis ball, and the wheel. Positions are logical
/// pixels of the view.
class ViewNavigator {
public:
    explicit ViewNavigator(CameraController& camera) : camera_(camera) {}
    void setPreset(NavigationPreset preset) { preset_ = preset; }
    [[nodiscard]] NavigationPreset preset() const { return preset_; }

    /// A drag of the camera has begun and not ended: the pointer belongs to it.
    [[nodiscard]] bool active() const { return navigation_ != Navigation::None || ballPressed_; }
    [[nodiscard]] bool onBall() const { return ballPressed_; }
    /// True: a press there belongs to the camera.
    [[nodiscard]] bool takes(QPointF p, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) const;
    /// Begins a drag where takes().
    bool press(QPointF p, Qt::MouseButton button, Qt::KeyboardModifiers modifiers);
    /// While active().
    void drag(QPointF p);
    /// While active(). Answers the end of the axis ball that was clicked.
    std::optional<ViewAxis> release(QPointF p, Qt::MouseButton button);
    void cancel();

    /// Lights the axis ball up where the pointer is over it; `enabled`: it may be. True: something changed.
    bool hover(QPointF p, bool enabled);
    [[nodiscard]] bool overBall() const { return overBall_; }

    /// Two fingers on a trackpad orbit, with Shift they pan; pinching, Ctrl and wheels zoom.
    void wheel(const QWheelEvent& e);
    /// A finger of a touch screen orbits, two pan and zoom: what is between them stays there.
    void lead(QPointF from, QPointF to) { camera_.orbit(to.x() - from.x(), to.y() - from.y()); }
    void lead(const std::array<QPointF, 2>& from, const std::array<QPointF, 2>& to);
    /// `value`: relative change of size since the last one.
    void pinch(double value, QPointF p);

    void paintBall(QPainter& painter, bool dark) const;

private:
    [[nodiscard]] QRectF ball() const;

    CameraController& camera_;
    NavigationPreset preset_ = NavigationPreset::Blender;
    Navigation navigation_ = Navigation::None;
    Qt::MouseButton button_ = Qt::NoButton;
    QPointF pointer_;  ///< at the last press() or drag()
    bool ballPressed_ = false, ballMoved_ = false, overBall_ = false;
    std::optional<ViewAxis> hovered_;
};

/// Notches of the wheel in an event, > 0: away from the user.
double notchesOf(const QWheelEvent& e);

}  // namespace imomushi
