// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPointF>
#include <QRectF>
#include <optional>

#include "ui/viewport/camera_controller.h"

class QPainter;

namespace imomushi {

/// The ball in the corner of the viewport that shows where the axes point; a click on one of its ends looks along it.
class AxisBall {
public:
    /// A square in logical pixels; `scale`: of the interface.
    static QRectF area(double viewportWidth, double scale);
    /// The end of an axis that is drawn at `p` (the nearest to the viewer), if any.
    static std::optional<ViewAxis> hit(const Eigen::Matrix3d& axes, const QRectF& area, const QPointF& p);
    /// Inside the ball, where a drag orbits.
    static bool contains(const QRectF& area, const QPointF& p);
    static void paint(QPainter& painter, const Eigen::Matrix3d& axes, const QRectF& area, std::optional<ViewAxis> hovered, bool inside,
                      bool dark);
};

}  // namespace imomushi
