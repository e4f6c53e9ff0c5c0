// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/list_panels.h"

#include <QEvent>
#include <QLabel>
#include <QListView>
#include <QPainter>
#include <QVBoxLayout>

#include "ui/widgets/appearance.h"
#include "ui/widgets/line_delegate.h"

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

QVBoxLayout* panelLayout(QWidget* panel) {
    panel->setObjectName(QStringLiteral("panel"));
    panel->setAttribute(Qt::WA_StyledBackground);
    auto* layout = new QVBoxLayout(panel);
    layout->setContentsMargins(8, 8, 6, 6);
    return layout;
}

}  // namespace

HistoryPanel::HistoryPanel(StudioDocument& document, QWidget* parent) : QWidget(parent) {
    model_ = new HistoryModel(document, this);
    list_ = new QListView(this);
    list_->setModel(model_);
    list_->setItemDelegate(new StepDelegate(list_));
    list_->setUniformItemSizes(true);
    list_->setAccessibleName(tr("History"));
    panelLayout(this)->addWidget(list_);
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

IssuesPanel::IssuesPanel(StudioDocument& document, QWidget* parent) : QWidget(parent) {
    model_ = new IssueModel(document, this);
    list_ = new QListView(this);
    list_->setModel(model_);
    list_->setMouseTracking(true);
    list_->setItemDelegate(new LineDelegate({IssueModel::IconRole, IssueModel::DetailRole, IssueModel::SeverityRole, true}, list_));
    empty_ = new QLabel(this);
    empty_->setProperty("role", "muted");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    auto* layout = panelLayout(this);
    layout->addWidget(list_);
    layout->addWidget(empty_, 1);
    const auto choose = [this, &document](const QModelIndex& index) {
        const PartId element = model_->element(index);
        if (!element) return;
        document.select({{SelectionItem::Kind::Element, element, {}, false}});
        Q_EMIT markWanted(element, model_->triangles(index));
    };
    connect(list_, &QListView::clicked, this, choose);
    connect(list_, &QListView::activated, this, [this, choose](const QModelIndex& index) {
        choose(index);
        Q_EMIT frameWanted();
    });
    connect(model_, &QAbstractItemModel::modelReset, this, &IssuesPanel::update);
    connect(&document, &StudioDocument::selectionChanged, this, [this] { Q_EMIT markWanted(0, {}); });
    update();
}

void IssuesPanel::update() {
    const bool none = model_->rowCount() == 0;
    list_->setVisible(!none);
    empty_->setVisible(none);
    empty_->setText(tr("Nothing asks for attention."));
    list_->setAccessibleName(tr("Issues"));
    Q_EMIT worthChanged();
}

void IssuesPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    model_->rebuild();
    update();
}

}  // namespace imomushi
