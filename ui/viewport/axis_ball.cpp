// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/axis_ball.h"

#include <QPainter>
#include <algorithm>
#include <array>
#include <cmath>

namespace imomushi {
namespace {

// Pixels of the design.
constexpr double kSide = 92.0, kMargin = 10.0, kEndRadius = 9.5;

struct End {
    ViewAxis view;
    Vec3 direction;
    const char* letter;  ///< positive ends only
    QColor color;
};

const std::array<End, 6>& ends() {
    // Colours that stay apart for colour-blind eyes; the letters say the same.
    static const std::array<End, 6> all = {{{ViewAxis::Right, Vec3::UnitX(), "X", QColor(230, 84, 92)},
                                            {ViewAxis::Left, -Vec3::UnitX(), nullptr, QColor(230, 84, 92)},
                                            {ViewAxis::Top, Vec3::UnitY(), "Y", QColor(138, 190, 62)},
                                            {ViewAxis::Bottom, -Vec3::UnitY(), nullptr, QColor(138, 190, 62)},
                                            {ViewAxis::Front, Vec3::UnitZ(), "Z", QColor(80, 140, 240)},
                                            {ViewAxis::Back, -Vec3::UnitZ(), nullptr, QColor(80, 140, 240)}}};
    return all;
}

double scaleOf(const QRectF& area) { return area.width() / kSide; }

double reach(const QRectF& area) { return area.width() / 2.0 - (kEndRadius + 2.0) * scaleOf(area); }

QPointF placeOf(const Eigen::Matrix3d& axes, const QRectF& area, const Vec3& direction) {
    const Vec3 c = axes.transpose() * direction;
    return area.center() + reach(area) * QPointF(c.x(), -c.y());
}

/// Indices of ends(), farthest first.
std::array<std::size_t, 6> byDepth(const Eigen::Matrix3d& axes) {
    std::array<std::size_t, 6> order = {0, 1, 2, 3, 4, 5};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return axes.col(2).dot(ends()[a].direction) < axes.col(2).dot(ends()[b].direction);
    });
    return order;
}

}  // namespace

QRectF AxisBall::area(double viewportWidth, double scale) {
    const double side = scale * kSide, margin = scale * kMargin;
    return {viewportWidth - side - margin, margin, side, side};
}

bool AxisBall::contains(const QRectF& area, const QPointF& p) {
    const QPointF d = p - area.center();
    return std::hypot(d.x(), d.y()) <= area.width() / 2.0;
}

std::optional<ViewAxis> AxisBall::hit(const Eigen::Matrix3d& axes, const QRectF& area, const QPointF& p) {
    const auto order = byDepth(axes);
    for (auto i = order.rbegin(); i != order.rend(); ++i) {
        const QPointF d = p - placeOf(axes, area, ends()[*i].direction);
        if (std::hypot(d.x(), d.y()) <= (kEndRadius + 1.5) * scaleOf(area)) return ends()[*i].view;
    }
    return std::nullopt;
}

void AxisBall::paint(QPainter& painter, const Eigen::Matrix3d& axes, const QRectF& area, std::optional<ViewAxis> hovered, bool inside,
                     bool dark) {
    const double scale = scaleOf(area);
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    if (inside) {
        painter.setPen(Qt::NoPen);
        painter.setBrush(dark ? QColor(255, 255, 255, 28) : QColor(0, 0, 0, 24));
        painter.drawEllipse(area);
    }
    QFont font = painter.font();
    font.setBold(true);
    font.setPixelSize(int(std::lround(11.0 * scale)));
    painter.setFont(font);
    for (const std::size_t i : byDepth(axes)) {
        const End& end = ends()[i];
        const QPointF at = placeOf(axes, area, end.direction);
        // What points away is dimmer.
        const double nearness = 0.5 + 0.5 * axes.col(2).dot(end.direction);
        QColor color = end.color;
        color.setAlphaF(float(0.55 + 0.45 * nearness));
        if (end.letter) {
            painter.setPen(QPen(color, 2.2 * scale));
            painter.drawLine(area.center(), at);
        }
        const bool lit = hovered == end.view;
        painter.setPen(QPen(lit ? QColor(Qt::white) : color, 1.6 * scale));
        QColor fill = color;
        if (!end.letter) fill.setAlphaF(float(lit ? 0.75 : 0.28));
        painter.setBrush(fill);
        const double radius = scale * (end.letter ? kEndRadius : kEndRadius - 2.5);
        painter.drawEllipse(at, radius, radius);
        if (end.letter) {
            painter.setPen(QColor(20, 22, 26));
            painter.drawText(QRectF(at.x() - radius, at.y() - radius, 2 * radius, 2 * radius), Qt::AlignCenter,
                             QString::fromLatin1(end.letter));
        }
    }
    painter.restore();
}

}  // namespace imomushi
