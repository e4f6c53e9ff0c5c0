// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/switch.h"

#include <QPainter>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr double kWidth = 30.0, kHeight = 17.0, kMargin = 3.0;  // logical pixels of the pill, and of the ring around it that shows the focus

}  // namespace

Switch::Switch(QWidget* parent) : QCheckBox(parent) {
    setFocusPolicy(Qt::TabFocus);
    setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
    setCursor(Qt::PointingHandCursor);
}

QSize Switch::sizeHint() const { return {px(kWidth + 2.0 * kMargin), px(kHeight + 2.0 * kMargin)}; }

void Switch::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const double margin = px(kMargin), high = px(kHeight), radius = high / 2.0;
    const QRectF pill(margin, (height() - high) / 2.0, px(kWidth), high);
    const bool contrast = Appearance::instance().theme() == Appearance::Theme::HighContrast;
    if (hasFocus()) {
        painter.setPen(QPen(themeColor(Appearance::Role::Accent), 1.0));
        painter.setBrush(Qt::NoBrush);
        painter.drawRoundedRect(pill.adjusted(-2.0, -2.0, 2.0, 2.0), radius + 2.0, radius + 2.0);
    }
    const QColor line = themeColor(contrast ? Appearance::Role::Text : underMouse() ? Appearance::Role::Text : Appearance::Role::Muted);
    painter.setPen(isChecked() ? Qt::NoPen : QPen(line, 1.2));
    painter.setBrush(isChecked() ? themeColor(Appearance::Role::Accent) : Qt::transparent);
    painter.drawRoundedRect(isChecked() ? pill : pill.adjusted(0.6, 0.6, -0.6, -0.6), radius, radius);
    // On: a large knob at the right; off: a small one at the left.
    const double knob = isChecked() ? radius - px(2.5) : radius - px(4.5);
    painter.setPen(Qt::NoPen);
    painter.setBrush(isChecked() ? themeColor(Appearance::Role::OnAccent) : line);
    painter.drawEllipse(QPointF(isChecked() ? pill.right() - radius : pill.left() + radius, pill.center().y()), knob, knob);
}

void Switch::enterEvent(QEnterEvent*) { update(); }
void Switch::leaveEvent(QEvent*) { update(); }

}  // namespace imomushi
