// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/choice_card.h"

#include <QPainter>
#include <algorithm>

#include "ui/widgets/appearance.h"

namespace imomushi {
namespace {

constexpr int kPad = 11, kSign = 14, kNoteLines = 2;

}  // namespace

ChoiceCard::ChoiceCard(const QString& title, const QString& note, QWidget* parent) : QAbstractButton(parent), note_(note) {
    setText(title);
    setAccessibleName(title);
    setAccessibleDescription(note);
    setCheckable(true);
    setFocusPolicy(Qt::StrongFocus);
    setAttribute(Qt::WA_Hover);
    QSizePolicy policy(QSizePolicy::Expanding, QSizePolicy::Minimum);  // all of a row are as high as the highest
    policy.setHeightForWidth(true);
    setSizePolicy(policy);
}

int ChoiceCard::heightForWidth(int width) const {
    const QFontMetrics metrics = fontMetrics();
    const auto lines = [&](const QRect& in, int how) { return metrics.boundingRect(in, Qt::AlignLeft | how, note_).height(); };
    // At least as high as its neighbours, with room for what wraps. A script that another font draws has higher lines.
    const int line = std::max(metrics.height(), lines({0, 0, QWIDGETSIZE_MAX, px(100)}, 0));
    const int note = lines({0, 0, std::max(1, width - 2 * px(kPad) - 2), QWIDGETSIZE_MAX}, Qt::TextWordWrap);
    return 2 * px(kPad) + metrics.height() + std::max(kNoteLines * line, note) + px(5);
}

QSize ChoiceCard::sizeHint() const { return {px(130), heightForWidth(px(130))}; }
QSize ChoiceCard::minimumSizeHint() const { return {px(96), heightForWidth(QWIDGETSIZE_MAX)}; }

// Layouts within layouts lose the height for a width where they are squeezed.
void ChoiceCard::resizeEvent(QResizeEvent* event) {
    QAbstractButton::resizeEvent(event);
    setMinimumHeight(heightForWidth(width()));
}

void ChoiceCard::paintEvent(QPaintEvent*) {
    using Role = Appearance::Role;
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    if (!isEnabled()) p.setOpacity(0.45);
    const QRectF frame = QRectF(rect()).adjusted(1, 1, -1, -1);
    p.setPen(Qt::NoPen);
    p.setBrush(themeColor(underMouse() && isEnabled() ? Role::Hover : Role::Field));
    p.drawRoundedRect(frame, px(8), px(8));
    if (isChecked()) {
        QColor tint = themeColor(Role::Accent);
        tint.setAlphaF(0.16f);
        p.setBrush(tint);
        p.drawRoundedRect(frame, px(8), px(8));
    }
    p.setBrush(Qt::NoBrush);
    p.setPen(QPen(themeColor(hasFocus() ? Role::Text : isChecked() ? Role::Accent : Role::Line), isChecked() || hasFocus() ? 1.5 : 1.0));
    p.drawRoundedRect(frame, px(8), px(8));

    QRectF area = frame.adjusted(px(kPad), px(kPad) - 1, -px(kPad), -px(kPad) + 1);
    QFont bold = font();
    bold.setWeight(QFont::DemiBold);
    p.setFont(bold);
    p.setPen(themeColor(Role::Text));
    const QFontMetrics metrics(bold);
    const double room = area.width() - (isChecked() ? px(kSign) + 2 : 0);
    p.drawText(QRectF(area.left(), area.top(), room, metrics.height()), Qt::AlignLeft | Qt::AlignVCenter, metrics.elidedText(text(), Qt::ElideRight, int(room)));
    if (isChecked())
        themedIcon(QStringLiteral("check"), Role::Accent)
            .paint(&p, QRect(int(area.right()) - px(kSign), int(area.top()) + (metrics.height() - px(kSign)) / 2, px(kSign), px(kSign)));
    p.setFont(font());
    p.setPen(themeColor(Role::Muted));
    area.setTop(area.top() + metrics.height() + px(3));
    p.drawText(area, Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap, note_);
}

}  // namespace imomushi
