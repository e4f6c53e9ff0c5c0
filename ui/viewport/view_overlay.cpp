// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/view_overlay.h"

#include <QFontMetricsF>
#include <QLocale>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "ui/models/studio_document.h"
#include "ui/models/take_deck.h"
#include "ui/models/texts.h"
#include "ui/viewport/axis_ball.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr float kBoxOpacity = 0.12f;

}  // namespace

void ViewOverlay::paint(QPainter& painter, StudioDocument& document) const {
    if (box || !lasso.isEmpty()) paintArea(painter);
    if (!tag.isEmpty()) paintTag(painter);
    if (!banner.isEmpty()) paintPill(painter, banner, false);
    else if (deck) paintTake(painter, document);
    if (deck && deck->counting()) paintCountdown(painter);
}

void ViewOverlay::paintArea(QPainter& painter) const {
    QColor fill = highlight;
    fill.setAlphaF(kBoxOpacity);
    painter.setPen(QPen(highlight, 1.0));
    painter.setBrush(fill);
    if (box) painter.drawRect(*box);
    painter.setRenderHint(QPainter::Antialiasing, !lasso.isEmpty());
    if (!lasso.isEmpty()) painter.drawPolygon(lasso, Qt::WindingFill);
    painter.setBrush(Qt::NoBrush);
}

// Below the pointer, and within the view.
void ViewOverlay::paintTag(QPainter& painter) const {
    const QFontMetricsF metrics(painter.font());
    const double high = metrics.height() * 1.4, wide = metrics.horizontalAdvance(tag) + 0.8 * high;
    const QRectF plate(std::clamp(pointer.x() + high, 0.0, std::max(0.0, size.width() - wide)), std::clamp(pointer.y() + 0.6 * high, 0.0, std::max(0.0, size.height() - high)), wide, high);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(dark ? QColor(20, 22, 26, 215) : QColor(255, 255, 255, 230));
    painter.drawRoundedRect(plate, 0.25 * high, 0.25 * high);
    painter.setPen(dark ? QColor(Qt::white) : QColor(31, 36, 33));
    painter.drawText(plate, Qt::AlignCenter, tag);
}

void ViewOverlay::paintTake(QPainter& painter, StudioDocument& document) const {
    const auto recording = document.session().recording();
    const Take* take = deck->take();
    if (!recording && !(deck->shown() && take)) return;
    const QString text = recording ? QStringLiteral("%1   %2").arg(QString::fromStdString(recording->take), clockText(recording->seconds))
                                   : ViewportWidget::tr("%1 – drag the character to leave it", "a take that is shown").arg(QString::fromStdString(take->name));
    paintPill(painter, text, recording.has_value());
    if (!recording) return;
    const double frame = QFontMetricsF(painter.font()).height() * 1.7 / 7.0;
    painter.setPen(QPen(QColor(kRecordRed), frame, Qt::SolidLine, Qt::SquareCap, Qt::MiterJoin));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(QRectF({}, QSizeF(size)).adjusted(frame / 2.0, frame / 2.0, -frame / 2.0, -frame / 2.0));
}

// Beside the ball of axes; a long text goes on below.
void ViewOverlay::paintPill(QPainter& painter, const QString& text, bool recording) const {
    const QFontMetricsF metrics(painter.font());
    const double row = metrics.height() * 1.7, dot = recording ? metrics.ascent() * 0.6 : 0.0, aside = recording ? dot + row * 0.4 : 0.0;
    const double right = AxisBall::area(size.width(), Appearance::instance().scale()).left() - 0.6 * row, left = 0.6 * row;
    const QRectF words = metrics.boundingRect(QRectF(0.0, 0.0, std::max(row, right - left - row - aside), 100.0 * row), Qt::TextWordWrap, text);
    const double wide = std::ceil(words.width()) + aside + row, high = words.height() + row - metrics.height();
    const QRectF pill(std::max(0.0, std::min((size.width() - wide) / 2.0, right - wide)), row * 0.6, wide, high);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(recording ? QColor(kRecordRed) : dark ? QColor(20, 22, 26, 190) : QColor(255, 255, 255, 210));
    painter.drawRoundedRect(pill, row / 2.0, row / 2.0);
    const QColor ink = recording || dark ? Qt::white : QColor(31, 36, 33);
    const QRectF line = pill.adjusted(row / 2.0 + aside, 0.0, -row / 2.0, 0.0);
    if (recording) {
        painter.setBrush(ink);
        painter.drawEllipse(QRectF(line.left() - aside, pill.center().y() - dot / 2.0, dot, dot));
    }
    painter.setPen(ink);
    painter.drawText(line.adjusted(0.0, 0.0, 1.0, 0.0), Qt::AlignLeft | Qt::AlignVCenter | Qt::TextWordWrap, text);
}

// In the middle and large, where nobody overlooks it.
void ViewOverlay::paintCountdown(QPainter& painter) const {
    const double radius = 3.2 * QFontMetricsF(painter.font()).height();
    const QRectF disc(0.5 * size.width() - radius, 0.5 * size.height() - radius, 2.0 * radius, 2.0 * radius);
    QColor red(kRecordRed);
    red.setAlphaF(0.85f);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(red);
    painter.drawEllipse(disc);
    QFont font = painter.font();
    font.setPixelSize(int(1.1 * radius));
    font.setWeight(QFont::DemiBold);
    painter.setFont(font);
    painter.setPen(Qt::white);
    painter.drawText(disc, Qt::AlignCenter, QLocale().toString(deck->counting()));
}

}  // namespace imomushi
