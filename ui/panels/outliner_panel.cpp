// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/outliner_panel.h"

#include <QAction>
#include <QEvent>
#include <QHeaderView>
#include <QLineEdit>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <QVBoxLayout>
#include <algorithm>
#include <functional>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/line_delegate.h"

namespace imomushi {
namespace {

/// States that ask for something stand out, those that every row has step back.
LineDelegate::IconStyle styleByState(const QModelIndex& row) {
    const QString icon = row.data(OutlinerModel::IconRole).toString();
    if (icon == u"stale") return {Appearance::Role::Warning};
    if (icon == u"none" || icon == u"eye-off" || icon == u"lock") return {Appearance::Role::Text};
    return {Appearance::Role::Muted, icon == u"unlock" || icon == u"eye" ? 0.55 : 1.0};
}

}  // namespace

OutlinerPanel::OutlinerPanel(StudioDocument& document, QWidget* parent) : QWidget(parent), document_(document) {
    usePanelBackground(this);
    model_ = new OutlinerModel(document, this);
    filter_ = new QSortFilterProxyModel(this);
    filter_->setSourceModel(model_);
    filter_->setRecursiveFilteringEnabled(true);
    filter_->setFilterCaseSensitivity(Qt::CaseInsensitive);

    search_ = new QLineEdit(this);
    search_->setClearButtonEnabled(true);
    search_->addAction(themedIcon(QStringLiteral("search"), Appearance::Role::Muted), QLineEdit::LeadingPosition);

    tree_ = new QTreeView(this);
    tree_->setModel(filter_);
    tree_->setHeaderHidden(true);
    tree_->setSelectionMode(QAbstractItemView::ExtendedSelection);
    tree_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed);
    tree_->setExpandsOnDoubleClick(false);
    tree_->setUniformRowHeights(true);
    tree_->setContextMenuPolicy(Qt::CustomContextMenu);
    tree_->setItemDelegate(new LineDelegate({OutlinerModel::IconRole, OutlinerModel::NoteRole}, styleByState, tree_));
    tree_->setMouseTracking(true);
    tree_->setDragDropMode(QAbstractItemView::DragDrop);
    tree_->setDefaultDropAction(Qt::LinkAction);
    tree_->header()->setStretchLastSection(false);
    tree_->header()->setMinimumSectionSize(1);
    tree_->header()->setSectionResizeMode(OutlinerModel::Name, QHeaderView::Stretch);
    for (int c = OutlinerModel::State; c < OutlinerModel::kColumns; ++c) tree_->header()->setSectionResizeMode(c, QHeaderView::Fixed);

    fill(new QVBoxLayout(this), QMargins(10, 8, 6, 6), Spacing{8}, search_, tree_);

    connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
        filter_->setFilterFixedString(text);
        tree_->expandAll();
    });
    connect(tree_, &QTreeView::clicked, this, [this](const QModelIndex& index) { model_->toggle(filter_->mapToSource(index)); });
    connect(tree_, &QTreeView::activated, this, [this](const QModelIndex& index) {
        if (const auto effect = model_->effect(filter_->mapToSource(index))) Q_EMIT effectWanted(*effect);
    });
    connect(tree_, &QTreeView::customContextMenuRequested, this, [this](const QPoint& at) { Q_EMIT contextMenuWanted(tree_->viewport()->mapToGlobal(at)); });
    connect(tree_->selectionModel(), &QItemSelectionModel::selectionChanged, this, &OutlinerPanel::takeSelection);
    connect(model_, &QAbstractItemModel::modelAboutToBeReset, this, [this] {
        rememberExpansion();
        syncing_ = true;
    });
    connect(model_, &QAbstractItemModel::modelReset, this, [this] {
        restoreExpansion();
        syncing_ = false;
        showSelection();
    });
    connect(&document, &StudioDocument::selectionChanged, this, &OutlinerPanel::showSelection);
    connect(&Appearance::instance(), &Appearance::changed, this, &OutlinerPanel::sizeColumns);
    sizeColumns();
    restoreExpansion();
    retranslate();
}

void OutlinerPanel::sizeColumns() {
    tree_->setIndentation(px(16));
    for (int c = OutlinerModel::State; c < OutlinerModel::kColumns; ++c) tree_->header()->resizeSection(c, px(26));
}

void OutlinerPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) {
        retranslate();
        model_->retranslate();
    }
}

void OutlinerPanel::retranslate() {
    search_->setPlaceholderText(tr("Filter"));
    search_->setAccessibleName(tr("Filter the outliner"));
    tree_->setAccessibleName(tr("Outliner"));
}

namespace {
QString keyOf(const OutlinerModel& model, const QModelIndex& index) {
    const auto item = model.item(index);
    return QStringLiteral("%1/%2").arg(index.data(OutlinerModel::KindRole).toInt()).arg(item ? item->part : 0);
}
void visit(const QAbstractItemModel& model, const QModelIndex& parent, const std::function<void(const QModelIndex&)>& f) {
    for (int row = 0; row < model.rowCount(parent); ++row) {
        const QModelIndex index = model.index(row, 0, parent);
        f(index);
        visit(model, index, f);
    }
}
}  // namespace

void OutlinerPanel::rememberExpansion() {
    collapsed_.clear();
    visit(*model_, {}, [this](const QModelIndex& index) {
        const QModelIndex shown = filter_->mapFromSource(index);
        if (shown.isValid() && model_->rowCount(index) > 0 && !tree_->isExpanded(shown)) collapsed_.insert(keyOf(*model_, index));
    });
}

void OutlinerPanel::restoreExpansion() {
    visit(*model_, {}, [this](const QModelIndex& index) {
        const QModelIndex shown = filter_->mapFromSource(index);
        if (shown.isValid()) tree_->setExpanded(shown, !collapsed_.contains(keyOf(*model_, index)));
    });
}

void OutlinerPanel::takeSelection() {
    if (syncing_) return;
    syncing_ = true;
    std::vector<SelectionItem> items;
    for (const QModelIndex& row : tree_->selectionModel()->selectedRows())
        for (const SelectionItem& item : model_->items(filter_->mapToSource(row)))
            if (std::ranges::find(items, item) == items.end()) items.push_back(item);  // a face may be selected by its joint, too
    document_.select(std::move(items));
    syncing_ = false;
}

void OutlinerPanel::showSelection() {
    if (syncing_) return;
    syncing_ = true;
    QItemSelection selection;
    QModelIndex last;
    for (const SelectionItem& item : document_.selection()) {
        const QModelIndex index = filter_->mapFromSource(model_->indexOf(item));
        if (!index.isValid()) continue;
        selection.select(index, index);
        last = index;
    }
    tree_->selectionModel()->select(selection, QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    if (last.isValid()) {
        tree_->selectionModel()->setCurrentIndex(last, QItemSelectionModel::NoUpdate);
        tree_->scrollTo(last);
    }
    syncing_ = false;
}

void OutlinerPanel::renameSelected() {
    const auto rows = tree_->selectionModel()->selectedRows();
    if (rows.isEmpty()) return;
    tree_->setFocus();
    tree_->setCurrentIndex(rows.first());
    tree_->edit(rows.first());
}

}  // namespace imomushi
