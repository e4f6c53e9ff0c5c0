// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/history_panel.h"

#include <QEvent>
#include <QListView>
#include <QPainter>
#include <QStyledItemDelegate>
#include <QVBoxLayout>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

// Steps that were undone are greyed, the present one has a mark: not told by colour alone.
class StepDelegate : public QStyledItemDelegate {
public:
    using QStyledItemDelegate::QStyledItemDelegate;
    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override {
        const auto& model = static_cast<const HistoryModel&>(*index.model());
        QStyleOptionViewItem row = option;
        initStyleOption(&row, index);
        row.text.clear();
        option.widget->style()->drawControl(QStyle::CE_ItemViewItem, &row, painter, option.widget);
        const bool present = index.row() == model.position(), done = index.data(HistoryModel::DoneRole).toBool();
        QRect rect = option.rect.adjusted(px(6), 0, -px(6), 0);
        const QRect mark(rect.left(), rect.center().y() - px(8), px(16), px(16));
        themedIcon(present ? QStringLiteral("chevron-right") : QStringLiteral("dot"), present ? Appearance::Role::Accent : Appearance::Role::Line).paint(painter, mark);
        rect.setLeft(mark.right() + px(8));
        QFont font = option.font;
        if (present) font.setWeight(QFont::DemiBold);
        if (!done) font.setItalic(true);
        painter->setFont(font);
        painter->setPen(themeColor(done ? Appearance::Role::Text : Appearance::Role::Muted));
        painter->drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, QFontMetrics(font).elidedText(index.data().toString(), Qt::ElideRight, rect.width()));
    }
    QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex&) const override { return {px(80), option.fontMetrics.height() + px(11)}; }
};

}  // namespace

HistoryPanel::HistoryPanel(StudioDocument& document, QWidget* parent) : QWidget(parent) {
    model_ = new HistoryModel(document, this);
    list_ = new QListView(this);
    list_->setModel(model_);
    list_->setItemDelegate(new StepDelegate(list_));
    list_->setUniformItemSizes(true);
    list_->setAccessibleName(tr("History"));
    usePanelBackground(this);
    fill(new QVBoxLayout(this), QMargins(8, 8, 6, 6), list_);
    connect(list_, &QListView::clicked, this, [this](const QModelIndex& index) { model_->goTo(index.row()); });
    connect(list_, &QListView::activated, this, [this](const QModelIndex& index) { model_->goTo(index.row()); });
    connect(model_, &HistoryModel::positionChanged, this, [this] {
        list_->scrollTo(model_->index(model_->position()));
        list_->viewport()->update();
    });
}

void HistoryPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    list_->setAccessibleName(tr("History"));
    model_->refresh();
}

}  // namespace imomushi
