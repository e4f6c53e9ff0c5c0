// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_body.h"

#include <Eigen/Geometry>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

/// From no error to the largest: dark blue, teal, yellow; brightness rises all the way, so that it can be read without colours (after "viridis").
QColor heat(double share) {
    static constexpr double stops[][3] = {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
    const double at = 4.0 * std::clamp(share, 0.0, 1.0);
    const int low = std::min(3, int(at));
    const double part = at - low;
    const auto mix = [&](int c) { return int(std::lround((1.0 - part) * stops[low][c] + part * stops[low + 1][c])); };
    return {mix(0), mix(1), mix(2)};
}

}  // namespace

AccuracyBody::AccuracyBody(QWidget* parent) : QWidget(parent) {
    setCursor(Qt::OpenHandCursor);
    connect(&Appearance::instance(), &Appearance::changed, this, [this] { update(); });
}

QSize AccuracyBody::sizeHint() const { return {px(420), px(240)}; }
QSize AccuracyBody::minimumSizeHint() const { return {px(180), px(120)}; }

void AccuracyBody::setTitles(const QString& shown, const QString& full, const QString& unit) {
    shownTitle_ = shown;
    fullTitle_ = full;
    unit_ = unit;
    setAccessibleName(shown);
    update();
}

void AccuracyBody::setParts(std::vector<Part> parts) {
    parts_ = std::move(parts);
    largest_ = 0.0;
    for (const Part& p : parts_)
        for (const float e : p.error) largest_ = std::max(largest_, double(e));
    update();
}

void AccuracyBody::draw(QPainter& painter, const QRectF& where, bool error) const {
    const Eigen::Matrix3d view = (Eigen::AngleAxisd(tilt_, Vec3::UnitX()) * Eigen::AngleAxisd(turn_, Vec3::UnitY())).toRotationMatrix();
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Part& p : parts_)
        for (const Points* points : {&p.shown, &p.full})
            for (Eigen::Index v = 0; v < points->rows(); ++v) {
                const Vec3 x = view * points->row(v).transpose();
                low = low.cwiseMin(x);
                high = high.cwiseMax(x);
            }
    if (!(high.x() > low.x())) return;
    const double scale = 0.92 * std::min(where.width() / (high.x() - low.x()), where.height() / std::max(1e-12, high.y() - low.y()));
    const Vec3 middle = 0.5 * (low + high);
    struct Face {
        double depth;
        QPointF corners[3];
        QColor color;
    };
    std::vector<Face> faces;
    const QColor plain = themeColor(Appearance::Role::Muted);
    for (const Part& p : parts_) {
        const Points& points = error ? p.shown : p.full;
        for (Eigen::Index t = 0; t < p.triangles.rows(); ++t) {
            Face face{0.0, {}, {}};
            Vec3 corner[3];
            double wrong = 0.0;
            for (int c = 0; c < 3; ++c) {
                const auto v = p.triangles(t, c);
                corner[c] = view * points.row(v).transpose();
                face.corners[c] = {where.center().x() + scale * (corner[c].x() - middle.x()), where.center().y() - scale * (corner[c].y() - middle.y())};
                face.depth += corner[c].z() / 3.0;
                wrong += std::max(0.0f, p.error[std::size_t(v)]) / 3.0;
            }
            const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
            if (!(normal.z() > 0.0)) continue;
            // Light enough that colours keep their meaning.
            const double light = (error ? 0.8 : 0.62) + (error ? 0.2 : 0.38) * std::max(0.0, normal.dot(Vec3(0.3, 0.5, 0.81)));
            const QColor base = error ? heat(largest_ > 0.0 ? wrong / largest_ : 0.0) : plain;
            face.color = QColor(int(base.red() * light), int(base.green() * light), int(base.blue() * light));
            faces.push_back(face);
        }
    }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.depth < b.depth; });
    for (const Face& face : faces) {
        painter.setPen(QPen(face.color, 0.8));  // closes the seams of antialiasing
        painter.setBrush(face.color);
        painter.drawPolygon(face.corners, 3);
    }
}

void AccuracyBody::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), themeColor(Appearance::Role::Field));
    const double line = fontMetrics().height(), legend = line + px(8), half = 0.5 * width();
    const QRectF area(px(6), line + px(4), half - px(12), height() - line - legend - px(8));
    painter.setPen(themeColor(Appearance::Role::Text));
    const auto title = [&](double x, const QString& text) {
        painter.drawText(QRectF(x + px(6), px(2), half - px(12), line), Qt::AlignLeft | Qt::AlignVCenter, fontMetrics().elidedText(text, Qt::ElideRight, int(half) - px(12)));
    };
    title(0.0, shownTitle_);
    title(half, fullTitle_);
    if (parts_.empty()) return;
    draw(painter, area, true);
    draw(painter, area.translated(half, 0.0), false);
    const QRectF bar(px(8), height() - legend + px(2), std::min(px(140) * 1.0, 0.4 * half), 0.55 * line);
    for (int i = 0; i < 48; ++i) painter.fillRect(QRectF(bar.left() + i * bar.width() / 48.0, bar.top(), bar.width() / 48.0 + 1.0, bar.height()), heat(i / 47.0));
    painter.setPen(themeColor(Appearance::Role::Text));
    painter.drawText(QRectF(bar.right() + px(8), bar.center().y() - 0.5 * line, width() - bar.right(), line), Qt::AlignLeft | Qt::AlignVCenter,
                     QStringLiteral("0 … %1 %2").arg(QLocale().toString(largest_, 'g', 2), unit_));
}

void AccuracyBody::mousePressEvent(QMouseEvent* event) { last_ = event->position(); }

void AccuracyBody::mouseMoveEvent(QMouseEvent* event) {
    if (!(event->buttons() & Qt::LeftButton)) return;
    const QPointF by = event->position() - last_;
    last_ = event->position();
    turn_ += 0.01 * by.x();
    tilt_ = std::clamp(tilt_ + 0.01 * by.y(), -1.5, 1.5);
    update();
}

}  // namespace imomushi
