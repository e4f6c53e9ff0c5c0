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
#include <tuple>

#include "ui/models/take_deck.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kMargin = 12.0;       // design pixels left and right, for half a playhead
constexpr double kLabelDistance = 70.0;  // design pixels from one number to the next, at least
constexpr double kBarHigh = 10.0, kMarkHigh = 11.0, kMarkWide = 10.0, kMarkGap = 3.0;

}  // namespace

TimeBar::TimeBar(QWidget* parent) : QAbstractSlider(parent) {
    setOrientation(Qt::Horizontal);
    setFocusPolicy(Qt::StrongFocus);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
    setMouseTracking(true);
    setTimes({});
}

QSize TimeBar::sizeHint() const { return {px(160), px(40) + fontMetrics().height()}; }

QRectF TimeBar::bar() const { return {double(px(kMargin)), double(height() - px(28)), width() - 2.0 * px(kMargin), double(px(kBarHigh))}; }

void TimeBar::setTimes(std::vector<double> times) {
    times_ = std::move(times);
    setRange(0, std::max(0, int(times_.size()) - 1));
    setPageStep(10);
    setEnabled(times_.size() > 1);
    held_ = hovered_ = Part::None;
    setSpan(0.0, times_.empty() ? 0.0 : times_.back());
    update();
}

void TimeBar::setSpan(double from, double to) {
    if (from == from_ && to == to_) return;
    from_ = from;
    to_ = to;
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

double TimeBar::timeAt(double x) const { return std::clamp((x - bar().left()) / std::max(1.0, bar().width()), 0.0, 1.0) * end(); }

void TimeBar::seek(double time) {
    const auto after = std::lower_bound(times_.begin(), times_.end(), time);
    int frame = int(after - times_.begin());
    if (frame == int(times_.size()) || (frame > 0 && time - times_[std::size_t(frame - 1)] < times_[std::size_t(frame)] - time)) --frame;
    ask(std::max(0, frame));
}

/// The mark at a place below the bar; the bar elsewhere.
TimeBar::Part TimeBar::partAt(QPointF at) const {
    if (times_.size() < 2 || recorded_ >= 0.0) return Part::None;
    if (at.y() < bar().bottom() + 0.5 * px(kMarkGap)) return Part::Bar;
    const double room = 0.5 * px(kMarkWide), from = std::abs(at.x() - (xOf(from_) - room)), to = std::abs(at.x() - (xOf(to_) + room));
    if (std::min(from, to) > px(kMarkWide)) return Part::Bar;
    return from < to ? Part::From : Part::To;
}

void TimeBar::drag(double x) {
    if (times_.empty()) return;
    const double time = timeAt(x);
    if (held_ == Part::Bar) seek(time);
    else if (held_ == Part::From) Q_EMIT spanWanted(std::min(time, to_), to_);
    else if (held_ == Part::To) Q_EMIT spanWanted(from_, std::max(time, from_));
}

void TimeBar::mousePressEvent(QMouseEvent* e) {
    if (e->button() != Qt::LeftButton) return;
    held_ = partAt(e->position());
    if (held_ == Part::Bar) drag(e->position().x());
}

void TimeBar::mouseMoveEvent(QMouseEvent* e) {
    if (e->buttons() & Qt::LeftButton) return drag(e->position().x());
    const Part over = partAt(e->position());
    if (over == hovered_) return;
    hovered_ = over;
    setCursor(over == Part::From || over == Part::To ? Qt::SizeHorCursor : Qt::ArrowCursor);
    update();
}

void TimeBar::mouseReleaseEvent(QMouseEvent*) { held_ = Part::None; }

void TimeBar::leaveEvent(QEvent*) {
    hovered_ = Part::None;
    update();
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
    const QRectF bar = this->bar();
    const double left = bar.left(), right = bar.right(), high = bar.height();

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
    if (isEnabled()) paintMarks(p);
    const double radius = px(8);
    p.setPen(Qt::NoPen);
    if (hasFocus()) {
        p.setBrush(Qt::NoBrush);
        p.setPen(QPen(themeColor(Role::Text), 1.5));
        p.drawEllipse(QPointF(x, bar.center().y()), radius + 2.0, radius + 2.0);
        p.setPen(Qt::NoPen);
    }
    p.setBrush(themeColor(isEnabled() ? Role::Accent : Role::Muted));
    p.drawEllipse(QPointF(x, bar.center().y()), radius, radius);
}

/// The part that is not played is crossed out by the colour of the panel; the marks hang below its ends.
void TimeBar::paintMarks(QPainter& p) {
    using Role = Appearance::Role;
    const QRectF bar = this->bar();
    const bool whole = from_ <= 0.0 && to_ >= end();
    const double from = xOf(from_), to = xOf(to_), radius = bar.height() / 2.0;
    p.setPen(Qt::NoPen);
    if (!whole) {
        QColor veil = themeColor(Role::Panel);
        veil.setAlphaF(0.7f);
        p.setBrush(veil);
        for (const QRectF& cut : {QRectF(QPointF(bar.left() - 1.0, bar.top() - 1.0), QPointF(from, bar.bottom() + 1.0)),
                                  QRectF(QPointF(to, bar.top() - 1.0), QPointF(bar.right() + 1.0, bar.bottom() + 1.0))})
            if (cut.width() > 1.5) p.drawRect(cut);
        p.setBrush(Qt::NoBrush);
        p.setPen(QPen(themeColor(Role::Accent), 1.5));
        p.drawRoundedRect(QRectF(QPointF(from, bar.top()), QPointF(to, bar.bottom())), radius / 2.0, radius / 2.0);
        p.setPen(Qt::NoPen);
    }
    const double top = bar.bottom() + px(kMarkGap), low = top + px(kMarkHigh), wide = px(kMarkWide);
    for (const auto& [part, x, out] : {std::tuple(Part::From, from, -wide), std::tuple(Part::To, to, wide)}) {
        const bool lit = hovered_ == part || held_ == part;
        p.setBrush(themeColor(lit ? Role::Text : whole ? Role::Muted : Role::Accent));
        p.drawPolygon(QPolygonF{QPointF(x, top), QPointF(x, low), QPointF(x + out, low), QPointF(x + out, low - px(3))});
    }
}

}  // namespace imomushi
