// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/issues_panel.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QListView>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/widgets/layouts.h"
#include "ui/widgets/line_delegate.h"

namespace imomushi {
namespace {

LineDelegate::IconStyle styleBySeverity(const QModelIndex& issue) {
    switch (Severity(issue.data(IssueModel::SeverityRole).toInt())) {
        case Severity::Error: return {Appearance::Role::Error};
        case Severity::Warning: return {Appearance::Role::Warning};
        case Severity::Info: break;
    }
    return {Appearance::Role::Info};
}

}  // namespace

IssuesPanel::IssuesPanel(StudioDocument& document, QWidget* parent) : QWidget(parent) {
    model_ = new IssueModel(document, this);
    list_ = new QListView(this);
    list_->setModel(model_);
    list_->setMouseTracking(true);
    list_->setItemDelegate(new LineDelegate({IssueModel::IconRole, IssueModel::DetailRole, true, IssueModel::RoomRole}, styleBySeverity, list_));
    empty_ = styled(new QLabel(this), "muted");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    usePanelBackground(this);
    all_ = named(new QPushButton(this), "repairAll");
    fill(new QVBoxLayout(this), QMargins(8, 8, 6, 6), list_, Share{empty_, 1}, all_);
    connect(all_, &QPushButton::clicked, this, [this] { repair(model_->repairAll()); });
    const auto choose = [this, &document](const QModelIndex& index) {
        if (const PartId character = model_->character(index)) {
            document.select({{SelectionItem::Kind::Character, character, {}, false}});
            Q_EMIT placeWanted(character, model_->triangles(index), model_->point(index));
            return;
        }
        const PartId element = model_->element(index);
        if (!element) return;
        document.select({{SelectionItem::Kind::Element, element, {}, false}});
        Q_EMIT markWanted(element, model_->triangles(index));
    };
    connect(list_, &QListView::clicked, this, choose);
    connect(list_, &QListView::activated, this, [this, choose](const QModelIndex& index) {
        choose(index);
        const bool place = model_->character(index) && (model_->point(index) || !model_->triangles(index).empty());
        place ? Q_EMIT placeFrameWanted() : Q_EMIT frameWanted();
    });
    connect(model_, &QAbstractItemModel::modelReset, this, &IssuesPanel::update);
    // Places of other issues, or of what is no longer selected.
    const auto unmark = [this] {
        Q_EMIT markWanted(0, {});
        Q_EMIT placeWanted(0, {}, std::nullopt);
    };
    connect(model_, &QAbstractItemModel::modelReset, this, unmark);
    connect(&document, &StudioDocument::selectionChanged, this, unmark);
    update();
}

void IssuesPanel::update() {
    const bool none = model_->rowCount() == 0;
    list_->setVisible(!none);
    empty_->setVisible(none);
    empty_->setText(tr("No issues."));
    list_->setAccessibleName(tr("Issues"));
    all_->setText(tr("Repair all"));
    all_->setVisible(!model_->repairAll().empty());
    addButtons();
    Q_EMIT problemsChanged();
}

void IssuesPanel::repair(const std::vector<Json>& commands) {
    list_->setFocus();  // buttons come and go with what is mended
    Q_EMIT repairWanted(commands);
}

void IssuesPanel::addButtons() {
    for (int row = 0; row < model_->rowCount(); ++row) {
        const QModelIndex index = model_->index(row);
        const auto command = model_->repair(index);
        if (!command) continue;
        auto* place = new QWidget(list_);
        auto* button = new QPushButton(index.data(IssueModel::RepairRole).toString(), place);
        button->setProperty("small", true);
        button->setToolTip(index.data(Qt::ToolTipRole).toString());
        button->setAccessibleName(QStringLiteral("%1 — %2").arg(button->text(), index.data().toString()));
        fill(new QHBoxLayout(place), QMargins(0, 0, px(6), px(3)), Share{button, 1, Qt::AlignRight | Qt::AlignBottom});
        model_->setRoom(index, button->sizeHint().width() + px(14));
        list_->setIndexWidget(index, place);
        connect(button, &QPushButton::clicked, this, [this, command] { repair({*command}); });
    }
}

void IssuesPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    model_->rebuild();
    update();
}

}  // namespace imomushi
