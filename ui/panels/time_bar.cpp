// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/time_bar.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "ui/models/take_deck.h"
#include "ui/panels/appearance.h"

namespace imomushi {
namespace {

constexpr double kMargin = 12.0;       // design pixels left and right, for half a playhead
constexpr double kLabelDistance = 70.0;  // design pixels from one number to the next, at least

}  // namespace

TimeBar::TimeBar(QWidget* parent) : QAbstractSlider(parent) {
    setOrientation(Qt::Horizontal);
    setFocusPolicy(Qt::StrongFocus);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
    setTimes({});
}

QSize TimeBar::sizeHint() const { return {px(160), px(34) + fontMetrics().height()}; }

void TimeBar::setTimes(std::vector<double> times) {
    times_ = std::move(times);
    setRange(0, std::max(0, int(times_.size()) - 1));
    setPageStep(10);
    setEnabled(times_.size() > 1);
    update();
}

void TimeBar::setTime(double time) {
    time_ = time;
    const auto after = std::upper_bound(times_.begin(), times_.end(), time + 1e-9);
    setValue(int(std::max<std::ptrdiff_t>(0, after - times_.begin() - 1)));
    update();
}

void TimeBar::setRecorded(double seconds) {
    if (seconds == recorded_) return;
    recorded_ = seconds;
    update();
}

double TimeBar::end() const {
    if (recorded_ >= 0.0) return std::max(recorded_, 1e-3);
    return times_.empty() ? 1.0 : std::max(times_.back(), 1e-3);
}

double TimeBar::xOf(double time) const { return px(kMargin) + (width() - 2.0 * px(kMargin)) * time / end(); }

bool TimeBar::event(QEvent* e) {
    if (e->type() == QEvent::ShortcutOverride) {
        // Home frames the view elsewhere; here it is the first frame.
        const auto* key = static_cast<QKeyEvent*>(e);
        for (const int own : {Qt::Key_Home, Qt::Key_End, Qt::Key_Left, Qt::Key_Right, Qt::Key_PageUp, Qt::Key_PageDown})
            if (key->key() == own && key->modifiers() == Qt::NoModifier) {
                e->accept();
                return true;
            }
    }
    return QAbstractSlider::event(e);
}

void TimeBar::ask(int frame) {
    if (times_.empty()) return;
    Q_EMIT wanted(std::clamp(frame, minimum(), maximum()));
}

void TimeBar::seek(double x) {
    if (times_.empty()) return;
    const double time = (x - px(kMargin)) / std::max(1.0, width() - 2.0 * px(kMargin)) * end();
    const auto after = std::lower_bound(times_.begin(), times_.end(), time);
    int frame = int(after - times_.begin());
    if (frame == int(times_.size()) || (frame > 0 && time - times_[std::size_t(frame - 1)] < times_[std::size_t(frame)] - time)) --frame;
    ask(std::max(0, frame));
}

void TimeBar::mousePressEvent(QMouseEvent* e) {
    if (e->button() == Qt::LeftButton) seek(e->position().x());
}

void TimeBar::mouseMoveEvent(QMouseEvent* e) {
    if (e->buttons() & Qt::LeftButton) seek(e->position().x());
}

void TimeBar::keyPressEvent(QKeyEvent* e) {
    switch (e->key()) {
        case Qt::Key_Left:
        case Qt::Key_Down: return ask(value() - singleStep());
        case Qt::Key_Right:
        case Qt::Key_Up: return ask(value() + singleStep());
        case Qt::Key_PageUp: return ask(value() - pageStep());
        case Qt::Key_PageDown: return ask(value() + pageStep());
        case Qt::Key_Home: return ask(minimum());
        case Qt::Key_End: return ask(maximum());
        default: QWidget::keyPressEvent(e);
    }
}

void TimeBar::wheelEvent(QWheelEvent* e) {
    ask(value() + (e->angleDelta().y() > 0 ? -1 : 1));
    e->accept();
}

void TimeBar::paintEvent(QPaintEvent*) {
    using Role = Appearance::Role;
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    const bool recording = recorded_ >= 0.0, filled = recording || !times_.empty();
    const double left = px(kMargin), right = width() - px(kMargin), high = px(10);
    const QRectF bar(left, height() - px(22), right - left, high);

    // The ruler: the roundest step whose numbers have room.
    if (filled) {
        const double wish = end() * px(kLabelDistance) / std::max(1.0, right - left);
        double step = std::pow(10.0, std::floor(std::log10(wish)));
        for (const double factor : {1.0, 2.0, 5.0, 10.0})
            if (step * factor >= wish) {
                step *= factor;
                break;
            }
        const int digits = std::clamp(-int(std::floor(std::log10(step) + 1e-9)), 0, 3);
        const double base = bar.top() - px(8);
        for (int tick = 0; 0.2 * step * tick <= end() * (1.0 + 1e-9); ++tick) {
            const double x = xOf(0.2 * step * tick);
            const bool named = tick % 5 == 0;
            p.setPen(QPen(themeColor(named ? Role::Muted : Role::Line), 1.0));
            p.drawLine(QPointF(x, base), QPointF(x, base - px(named ? 6 : 3)));
            if (!named) continue;
            const QString text = tr("%1 s").arg(QLocale().toString(step * (tick / 5), 'f', digits));
            const double wide = p.fontMetrics().horizontalAdvance(text);
            const double at = std::clamp(x - wide / 2.0, 0.0, width() - wide);
            p.setPen(themeColor(Role::Muted));
            p.drawText(QPointF(at, base - px(9)), text);
        }
    }

    p.setPen(Qt::NoPen);
    p.setBrush(themeColor(Role::Field));
    p.drawRoundedRect(bar, high / 2.0, high / 2.0);
    if (!filled) return;
    const double x = recording ? right : xOf(std::min(time_, end()));
    QColor done = recording ? QColor(kRecordRed) : themeColor(Role::Accent);
    if (!recording) done.setAlphaF(0.45f);
    p.setBrush(done);
    p.drawRoundedRect(QRectF(left, bar.top(), std::max(high, x - left), high), high / 2.0, high / 2.0);
    if (recording) return;
    const double radius = px(8);
    if (hasFocus()) {
        p.setBrush(Qt::NoBrush);
        p.setPen(QPen(themeColor(Role::Text), 1.5));
        p.drawEllipse(QPointF(x, bar.center().y()), radius + 2.0, radius + 2.0);
        p.setPen(Qt::NoPen);
    }
    p.setBrush(themeColor(isEnabled() ? Role::Accent : Role::Muted));
    p.drawEllipse(QPointF(x, bar.center().y()), radius, radius);
}

}  // namespace imomushi
