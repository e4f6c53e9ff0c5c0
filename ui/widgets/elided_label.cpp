// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/elided_label.h"

#include <QPainter>
#include <QStyle>
#include <algorithm>

namespace imomushi {

ElidedLabel::ElidedLabel(QWidget* parent) : QLabel(parent) { setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred); }

void ElidedLabel::setText(const QString& text) {
    QLabel::setText(text);
    setToolTip(text);
}

void ElidedLabel::setRoomFor(const QString& widest) {
    if (widest == widest_) return;
    widest_ = widest;
    updateGeometry();
}

QSize ElidedLabel::sizeHint() const {
    QSize size = QLabel::sizeHint();
    if (!widest_.isEmpty()) size.setWidth(std::max(size.width(), fontMetrics().horizontalAdvance(widest_) + 2 * margin()));
    return size;
}

void ElidedLabel::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QString shown = fontMetrics().elidedText(text(), Qt::ElideRight, contentsRect().width());
    style()->drawItemText(&painter, contentsRect(), Qt::AlignLeft | Qt::AlignVCenter, palette(), isEnabled(), shown, foregroundRole());
}

}  // namespace imomushi
