// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/line_delegate.h"

#include <QApplication>
#include <QPainter>

namespace imomushi {
namespace {
constexpr int kIcon = 17, kGap = 7;
}

int LineDelegate::roomOf(const QModelIndex& index) const { return roles_.room < 0 ? 0 : index.data(roles_.room).toInt(); }

QSize LineDelegate::sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const {
    const int line = option.fontMetrics.height();
    const bool two = roles_.noteBelow && !index.data(roles_.note).toString().isEmpty();
    const int room = roomOf(index);
    const int text = roles_.room < 0 ? option.fontMetrics.horizontalAdvance(index.data(Qt::DisplayRole).toString()) : room;
    return {px(kIcon + kGap + 8) + text, two ? 2 * line + px(room > 0 ? 24 : 16) : line + px(11)};
}

void LineDelegate::paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const {
    QStyleOptionViewItem row = option;
    initStyleOption(&row, index);
    row.text.clear();
    row.icon = {};
    const QWidget* widget = option.widget;
    (widget ? widget->style() : QApplication::style())->drawControl(QStyle::CE_ItemViewItem, &row, painter, widget);

    QRect rect = option.rect;
    const QString icon = roles_.icon < 0 ? QString() : index.data(roles_.icon).toString();
    const QString text = index.data(Qt::DisplayRole).toString();
    const bool enabled = option.state & QStyle::State_Enabled;
    if (!icon.isEmpty()) {
        const IconStyle style = styles_ ? styles_(index) : IconStyle();
        QRect place(0, 0, px(kIcon), px(kIcon));
        if (text.isEmpty()) {
            place.moveCenter(rect.center());
        } else {
            place.moveTop(roles_.noteBelow ? rect.top() + px(8) : rect.center().y() - place.height() / 2);
            place.moveLeft(rect.left() + px(3));
        }
        painter->setOpacity(style.opacity);
        themedIcon(icon, style.color).paint(painter, place);
        painter->setOpacity(1.0);
        rect.setLeft(place.right() + px(kGap));
    } else {
        rect.setLeft(rect.left() + px(8));
    }
    rect.setRight(rect.right() - px(4));
    if (text.isEmpty()) return;

    const QString note = roles_.note < 0 ? QString() : index.data(roles_.note).toString();
    painter->setFont(option.font);
    QColor ink = themeColor(Appearance::Role::Text);
    if (!enabled) ink = themeColor(Appearance::Role::Muted);
    if (roles_.noteBelow && !note.isEmpty()) {
        const int line = option.fontMetrics.height();
        const QRect top(rect.left(), rect.top() + px(7), rect.width(), line), below(rect.left(), top.bottom() + px(roomOf(index) > 0 ? 6 : 2), rect.width() - roomOf(index), line);
        painter->setPen(ink);
        painter->drawText(top, Qt::AlignLeft | Qt::AlignVCenter, option.fontMetrics.elidedText(text, Qt::ElideRight, top.width()));
        painter->setPen(themeColor(Appearance::Role::Muted));
        painter->drawText(below, Qt::AlignLeft | Qt::AlignVCenter, option.fontMetrics.elidedText(note, Qt::ElideRight, below.width()));
        return;
    }
    painter->setPen(ink);
    const QString shown = option.fontMetrics.elidedText(text, Qt::ElideRight, rect.width());
    painter->drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, shown);
    if (note.isEmpty()) return;
    rect.setLeft(rect.left() + option.fontMetrics.horizontalAdvance(shown) + px(10));
    if (rect.width() < px(30)) return;
    painter->setPen(themeColor(Appearance::Role::Muted));
    painter->drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, option.fontMetrics.elidedText(note, Qt::ElideRight, rect.width()));
}

void LineDelegate::updateEditorGeometry(QWidget* editor, const QStyleOptionViewItem& option, const QModelIndex& index) const {
    QStyledItemDelegate::updateEditorGeometry(editor, option, index);
    editor->setGeometry(option.rect.adjusted(px(kIcon + kGap) - px(2), px(2), -px(2), -px(2)));
}

}  // namespace imomushi
