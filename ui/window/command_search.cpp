// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/command_search.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QStyledItemDelegate>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kActionRole = Qt::UserRole, kKeysRole = Qt::UserRole + 1, kEnabledRole = Qt::UserRole + 2;

class ActionDelegate : public QStyledItemDelegate {
public:
    using QStyledItemDelegate::QStyledItemDelegate;
    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override {
        QStyleOptionViewItem row = option;
        initStyleOption(&row, index);
        row.text.clear();
        row.icon = {};
        option.widget->style()->drawControl(QStyle::CE_ItemViewItem, &row, painter, option.widget);
        QRect rect = option.rect.adjusted(px(10), 0, -px(12), 0);
        const bool enabled = index.data(kEnabledRole).toBool();
        const QRect mark(rect.left(), rect.center().y() - px(9), px(18), px(18));
        index.data(Qt::DecorationRole).value<QIcon>().paint(painter, mark, Qt::AlignCenter, enabled ? QIcon::Normal : QIcon::Disabled);
        rect.setLeft(mark.right() + px(11));
        painter->setPen(themeColor(enabled ? Appearance::Role::Text : Appearance::Role::Muted));
        painter->drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, index.data().toString());
        painter->setPen(themeColor(Appearance::Role::Muted));
        painter->drawText(rect, Qt::AlignRight | Qt::AlignVCenter, index.data(kKeysRole).toString());
    }
    QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex&) const override { return {px(100), option.fontMetrics.height() + px(14)}; }
};

}  // namespace

int searchScore(const QString& typed, const QString& text) {
    if (typed.isEmpty()) return 1;
    const QString needle = typed.toCaseFolded(), hay = text.toCaseFolded();
    if (hay.startsWith(needle)) return 1000;
    if (hay.contains(QLatin1Char(' ') + needle)) return 800;
    if (hay.contains(needle)) return 600;
    qsizetype at = -1;
    for (const QChar c : needle) {
        if (c.isSpace()) continue;
        at = hay.indexOf(c, at + 1);
        if (at < 0) return 0;
    }
    return std::max(1, int(300 - at));
}

// A child of the window and no window of its own: its round corners need no compositor.
CommandSearch::CommandSearch(const QList<QAction*>& actions, QWidget* window) : QFrame(window), actions_(actions) {
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("search"));
    line_ = new QLineEdit(this);
    line_->setPlaceholderText(tr("Search commands"));
    line_->setAccessibleName(tr("Search commands"));
    line_->addAction(themedIcon(QStringLiteral("search"), Appearance::Role::Muted), QLineEdit::LeadingPosition);
    line_->installEventFilter(this);
    auto* rule = named(new QFrame(this), "rule");
    list_ = new QListWidget(this);
    list_->setItemDelegate(new ActionDelegate(list_));
    list_->setUniformItemSizes(true);
    list_->setFocusPolicy(Qt::NoFocus);
    list_->setMouseTracking(true);
    list_->setAccessibleName(tr("Commands"));
    imomushi::fill(new QVBoxLayout(this), QMargins(px(8), px(6), px(8), px(8)), Spacing{px(6)}, line_, rule, list_);
    connect(line_, &QLineEdit::textChanged, this, &CommandSearch::fill);
    connect(list_, &QListWidget::itemClicked, this, &CommandSearch::run);
    resize(px(560), px(420));
    fill({});
}

void CommandSearch::popUp() {
    const QWidget* window = parentWidget();
    move((window->width() - width()) / 2, window->height() / 6);
    show();
    raise();
    line_->setFocus();
}

void CommandSearch::fill(const QString& text) {
    std::vector<std::pair<int, QAction*>> found;
    for (QAction* action : actions_)
        if (const int score = searchScore(text, commandName(*action)); score > 0) found.emplace_back(score, action);
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    list_->clear();
    for (const auto& [score, action] : found) {
        auto* item = new QListWidgetItem(action->icon(), commandName(*action), list_);
        item->setData(kActionRole, QVariant::fromValue(static_cast<QObject*>(action)));
        item->setData(kKeysRole, action->shortcut().toString(QKeySequence::NativeText));
        item->setData(kEnabledRole, action->isEnabled());
    }
    list_->setCurrentRow(0);
}

void CommandSearch::run() {
    const auto* item = list_->currentItem();
    if (!item || !item->data(kEnabledRole).toBool()) return;
    auto* action = static_cast<QAction*>(item->data(kActionRole).value<QObject*>());
    close();
    // After this popup is gone: the action may open a window of its own.
    QMetaObject::invokeMethod(action, &QAction::trigger, Qt::QueuedConnection);
}

bool CommandSearch::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::FocusOut && static_cast<QFocusEvent*>(event)->reason() != Qt::ActiveWindowFocusReason) close();
    if (event->type() != QEvent::KeyPress) return QFrame::eventFilter(watched, event);
    const int key = static_cast<QKeyEvent*>(event)->key();
    const int row = list_->currentRow(), last = list_->count() - 1;
    if (key == Qt::Key_Down) list_->setCurrentRow(std::min(row + 1, last));
    else if (key == Qt::Key_Up) list_->setCurrentRow(std::max(row - 1, 0));
    else if (key == Qt::Key_Return || key == Qt::Key_Enter) run();
    else if (key == Qt::Key_Escape) close();
    else return QFrame::eventFilter(watched, event);
    return true;
}

}  // namespace imomushi
