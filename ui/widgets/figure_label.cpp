// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/figure_label.h"

#include <QPainter>
#include <algorithm>

namespace imomushi {

FigureLabel::FigureLabel(QWidget* parent) : QWidget(parent) { setSizePolicy(QSizePolicy::Minimum, QSizePolicy::Preferred); }

void FigureLabel::setText(const QString& text) {
    if (text == text_) return;
    text_ = text;
    setAccessibleName(text);
    updateGeometry();
    update();
}

void FigureLabel::setRole(Appearance::Role role) {
    role_ = role;
    update();
}

int FigureLabel::advance(QChar c) const {
    const QFontMetrics metrics = fontMetrics();
    if (!c.isDigit()) return metrics.horizontalAdvance(c);
    int widest = 0;
    for (char digit = '0'; digit <= '9'; ++digit) widest = std::max(widest, metrics.horizontalAdvance(QLatin1Char(digit)));
    return widest;
}

QSize FigureLabel::sizeHint() const {
    int width = 0;
    for (const QChar c : text_) width += advance(c);
    return {width, fontMetrics().height()};
}

void FigureLabel::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setPen(themeColor(role_));
    int x = width() - sizeHint().width();
    const int baseline = (height() + fontMetrics().ascent() - fontMetrics().descent()) / 2;
    for (const QChar c : text_) {
        const int wide = advance(c);
        painter.drawText(x + (wide - fontMetrics().horizontalAdvance(c)) / 2, baseline, QString(c));
        x += wide;
    }
}

}  // namespace imomushi
