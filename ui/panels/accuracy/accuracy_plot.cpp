// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/accuracy/accuracy_plot.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>

#include "ui/widgets/appearance.h"

namespace imomushi {

using Role = Appearance::Role;

AccuracyPlot::AccuracyPlot(QWidget* parent) : QWidget(parent) {
    setMouseTracking(true);
    setFocusPolicy(Qt::StrongFocus);
    connect(&Appearance::instance(), &Appearance::changed, this, [this] {
        updateGeometry();
        update();
    });
}

QSize AccuracyPlot::sizeHint() const { return {px(400), px(260)}; }
QSize AccuracyPlot::minimumSizeHint() const { return {px(165), px(150)}; }

void AccuracyPlot::setTitles(const QString& title, const QString& cost, const QString& error) {
    title_ = title;
    costTitle_ = cost;
    errorTitle_ = error;
    setAccessibleName(title);
    update();
}

bool AccuracyPlot::drawn(int point) const {
    return point >= 0 && point < int(points_.size()) && points_[std::size_t(point)].cost > 0.0 && points_[std::size_t(point)].error > 0.0;
}

void AccuracyPlot::setPoints(std::vector<Point> points) {
    points_ = std::move(points);
    std::vector<double> costs, errors;
    for (int i = 0; i < int(points_.size()); ++i)
        if (drawn(i)) costs.push_back(points_[std::size_t(i)].cost), errors.push_back(points_[std::size_t(i)].error);
    x_ = LogAxis::around(costs);
    y_ = LogAxis::around(errors);
    hovered_ = -1;
    update();
}

void AccuracyPlot::setChosen(int point) {
    if (chosen_ == point) return;
    chosen_ = point;
    update();
}

void AccuracyPlot::setFloor(double error) {
    floor_ = error;
    update();
}

void AccuracyPlot::setBudget(double cost) {
    budget_ = cost;
    update();
}

QRectF AccuracyPlot::area() const {
    const QFontMetricsF metrics(font());
    return QRectF(rect()).adjusted(metrics.height() + metrics.horizontalAdvance(QStringLiteral("0.05")) + px(12), 1.9 * metrics.height(), -px(10), -(2.4 * metrics.height() + px(4)));
}

QPointF AccuracyPlot::place(int point) const {
    const QRectF a = area();
    const Point& p = points_[std::size_t(point)];
    return {a.left() + x_.at(p.cost) * a.width(), a.bottom() - y_.at(p.error) * a.height()};
}

void AccuracyPlot::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF a = area();
    const QFontMetricsF metrics(font());
    const QColor ink = themeColor(Role::Text), muted = themeColor(Role::Muted), line = themeColor(Role::Line), accent = themeColor(Role::Accent), warn = themeColor(Role::Warning);
    QFont bold = font();
    bold.setWeight(QFont::DemiBold);
    painter.setFont(bold);
    painter.setPen(ink);
    painter.drawText(QRectF(px(4), 0, width() - px(8), 1.6 * metrics.height()), Qt::AlignLeft | Qt::AlignVCenter, painter.fontMetrics().elidedText(title_, Qt::ElideRight, width() - px(8)));
    QFont small = font();
    small.setPointSizeF(0.86 * font().pointSizeF());
    painter.setFont(small);
    painter.fillRect(a, themeColor(Role::Field));
    if (floor_ > 0.0 && y_.at(floor_) > 0.0) {
        QColor shade = muted;
        shade.setAlphaF(0.16f);
        const double at = std::max(a.top(), a.bottom() - y_.at(floor_) * a.height());
        painter.fillRect(QRectF(QPointF(a.left(), at), a.bottomRight()), shade);
    }
    double reach = -1e9;
    for (const auto& tick : x_.ticks()) {
        const double at = a.left() + x_.at(tick.value) * a.width();
        painter.setPen(QPen(line, tick.major ? 1.2 : 0.6));
        painter.drawLine(QPointF(at, a.top()), QPointF(at, a.bottom()));
        const QString text = QString::fromStdString(tickText(tick.value));
        const double half = 0.5 * painter.fontMetrics().horizontalAdvance(text);
        if (at - half < reach + px(4) || at + half > width()) continue;
        reach = at + half;
        painter.setPen(tick.major ? ink : muted);
        painter.drawText(QRectF(at - half - 1.0, a.bottom() + px(2), 2.0 * half + 2.0, metrics.height()), Qt::AlignCenter, text);
    }
    for (const auto& tick : y_.ticks()) {
        const double at = a.bottom() - y_.at(tick.value) * a.height();
        painter.setPen(QPen(line, tick.major ? 1.2 : 0.6));
        painter.drawLine(QPointF(a.left(), at), QPointF(a.right(), at));
        painter.setPen(tick.major ? ink : muted);
        painter.drawText(QRectF(0, at - 0.5 * metrics.height(), a.left() - px(5), metrics.height()), Qt::AlignRight | Qt::AlignVCenter, QString::fromStdString(tickText(tick.value)));
    }
    painter.setPen(muted);
    painter.drawText(QRectF(a.left(), a.bottom() + px(2) + 1.1 * metrics.height(), a.width(), metrics.height() + px(2)), Qt::AlignCenter,
                     painter.fontMetrics().elidedText(costTitle_, Qt::ElideRight, int(a.width())));
    painter.save();
    painter.translate(0.0, a.center().y());
    painter.rotate(-90.0);
    painter.drawText(QRectF(-0.5 * a.height(), 0, a.height(), metrics.height() + px(2)), Qt::AlignCenter, painter.fontMetrics().elidedText(errorTitle_, Qt::ElideRight, int(a.height())));
    painter.restore();

    painter.setClipRect(a.adjusted(-px(9), -px(9), px(9), px(9)));
    if (budget_ > 0.0 && x_.at(budget_) >= 0.0 && x_.at(budget_) <= 1.0) {
        const double at = a.left() + x_.at(budget_) * a.width();
        painter.setPen(QPen(warn, px(1.5), Qt::DashLine));
        painter.drawLine(QPointF(at, a.top()), QPointF(at, a.bottom()));
    }
    std::vector<int> front;
    for (int i = 0; i < int(points_.size()); ++i)
        if (points_[std::size_t(i)].front && drawn(i)) front.push_back(i);
    std::sort(front.begin(), front.end(), [&](int l, int r) { return points_[std::size_t(l)].cost < points_[std::size_t(r)].cost; });
    QPainterPath path;
    for (const int i : front) {
        const QPointF p = place(i);
        if (path.elementCount() == 0) {
            path.moveTo(p);
        } else {
            path.lineTo(p.x(), path.currentPosition().y());
            path.lineTo(p);
        }
    }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(accent, px(1.6)));
    painter.drawPath(path);
    const double r = px(4);
    for (const bool onFront : {false, true})
        for (int i = 0; i < int(points_.size()); ++i) {
            if (!drawn(i) || points_[std::size_t(i)].front != onFront) continue;
            const QPointF p = place(i);
            painter.setPen(QPen(onFront ? accent : muted, px(1.5)));
            painter.setBrush(onFront ? accent : themeColor(Role::Field));
            painter.drawEllipse(p, r, r);
        }
    painter.setBrush(Qt::NoBrush);
    for (int i = 0; i < int(points_.size()); ++i) {
        if (!drawn(i)) continue;
        const QPointF p = place(i);
        if (points_[std::size_t(i)].present) {
            painter.setPen(QPen(warn, px(2)));
            painter.drawRect(QRectF(p.x() - 2.0 * r, p.y() - 2.0 * r, 4.0 * r, 4.0 * r));
        }
        if (i == chosen_ || i == hovered_) {
            painter.setPen(QPen(ink, px(i == chosen_ ? 2 : 1)));
            painter.drawEllipse(p, 1.75 * r, 1.75 * r);
        }
    }
    painter.setClipping(false);
    painter.setPen(hasFocus() ? accent : line);
    painter.drawRect(a);
}

int AccuracyPlot::near(const QPointF& at) const {
    int best = -1;
    double least = px(14) * double(px(14));
    for (int i = 0; i < int(points_.size()); ++i) {
        if (!drawn(i)) continue;
        const QPointF d = place(i) - at;
        if (const double square = QPointF::dotProduct(d, d); square < least) least = square, best = i;
    }
    return best;
}

void AccuracyPlot::hover(int point) {
    if (hovered_ == point) return;
    hovered_ = point;
    update();
    Q_EMIT hovered(point);
}

void AccuracyPlot::mouseMoveEvent(QMouseEvent* event) {
    const int point = near(event->position());
    hover(point);
    setCursor(point >= 0 ? Qt::PointingHandCursor : Qt::ArrowCursor);
    if (point >= 0)
        QToolTip::showText(event->globalPosition().toPoint(), points_[std::size_t(point)].tip, this);
    else
        QToolTip::hideText();
}

void AccuracyPlot::mousePressEvent(QMouseEvent* event) {
    if (const int point = near(event->position()); point >= 0 && event->button() == Qt::LeftButton) Q_EMIT clicked(point);
}

void AccuracyPlot::leaveEvent(QEvent*) { hover(-1); }

void AccuracyPlot::keyPressEvent(QKeyEvent* event) {
    const int step = event->key() == Qt::Key_Right ? 1 : event->key() == Qt::Key_Left ? -1 : 0;
    if (step == 0) return QWidget::keyPressEvent(event);
    std::vector<int> order;
    for (int i = 0; i < int(points_.size()); ++i)
        if (drawn(i)) order.push_back(i);
    if (order.empty()) return;
    std::sort(order.begin(), order.end(), [&](int l, int r) { return points_[std::size_t(l)].cost < points_[std::size_t(r)].cost; });
    const auto now = std::find(order.begin(), order.end(), chosen_);
    const auto at = now == order.end() ? 0 : std::clamp<std::ptrdiff_t>(now - order.begin() + step, 0, std::ptrdiff_t(order.size()) - 1);
    Q_EMIT clicked(order[std::size_t(at)]);
}

}  // namespace imomushi
