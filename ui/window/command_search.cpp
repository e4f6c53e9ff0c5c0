// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/command_search.h"

#include <QEvent>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QStyledItemDelegate>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kIndexRole = Qt::UserRole, kNoteRole = Qt::UserRole + 1, kEnabledRole = Qt::UserRole + 2;
constexpr int kOfKind = 3;  // a name counts so many times more than what kind of thing it is

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
        const QString name = index.data().toString();
        painter->drawText(rect, Qt::AlignLeft | Qt::AlignVCenter, painter->fontMetrics().elidedText(name, Qt::ElideRight, rect.width()));
        rect.setLeft(rect.left() + painter->fontMetrics().horizontalAdvance(name) + px(16));
        painter->setPen(themeColor(Appearance::Role::Muted));
        painter->drawText(rect, Qt::AlignRight | Qt::AlignVCenter, painter->fontMetrics().elidedText(index.data(kNoteRole).toString(), Qt::ElideRight, rect.width()));
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
CommandSearch::CommandSearch(std::vector<Findable> all, QWidget* window) : QFrame(window), all_(std::move(all)) {
    setAttribute(Qt::WA_DeleteOnClose);
    setObjectName(QStringLiteral("search"));
    line_ = new QLineEdit(this);
    line_->setPlaceholderText(tr("Search"));
    line_->setAccessibleName(tr("Search"));
    line_->addAction(themedIcon(QStringLiteral("search"), Appearance::Role::Muted), QLineEdit::LeadingPosition);
    line_->installEventFilter(this);
    auto* rule = named(new QFrame(this), "rule");
    none_ = styled(named(new QLabel(this), "nothingFound"), "muted");
    none_->setWordWrap(true);
    none_->setContentsMargins(px(10), px(8), px(10), px(8));
    list_ = new QListWidget(this);
    list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    list_->setItemDelegate(new ActionDelegate(list_));
    list_->setUniformItemSizes(true);
    list_->setFocusPolicy(Qt::NoFocus);
    list_->setMouseTracking(true);
    list_->setAccessibleName(tr("Found"));
    imomushi::fill(new QVBoxLayout(this), QMargins(px(8), px(6), px(8), px(8)), Spacing{px(6)}, line_, rule, Share{list_, 1}, none_)
        ->addStretch();  // where nothing is found the words stay below the line
    connect(line_, &QLineEdit::textChanged, this, &CommandSearch::fill);
    connect(list_, &QListWidget::itemClicked, this, &CommandSearch::run);
    resize(QSize(px(620), px(420)).boundedTo(window->size() * 0.8));
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
    const QString typed = text.trimmed();
    std::vector<std::pair<int, std::size_t>> found;
    for (std::size_t i = 0; i < all_.size(); ++i) {
        const int score = std::max(kOfKind * searchScore(typed, all_[i].name), all_[i].kind.isEmpty() ? 0 : searchScore(typed, all_[i].kind));
        if (score > 0) found.emplace_back(score, i);
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    list_->clear();
    for (const auto& [score, i] : found) {
        const Findable& one = all_[i];
        auto* item = new QListWidgetItem(one.icon, one.name, list_);
        item->setData(kIndexRole, int(i));
        item->setData(kNoteRole, !one.why.isEmpty() ? one.why : !one.keys.isEmpty() ? one.keys : one.kind);
        item->setData(kEnabledRole, one.why.isEmpty());
        item->setToolTip(one.why);
    }
    list_->setCurrentRow(0);
    list_->setVisible(!found.empty());
    none_->setVisible(found.empty());
    none_->setText(tr("Nothing is called “%1”. You can search for commands, panels, effects, settings and samples, and for the parts, takes and clips of this project.").arg(typed));
}

void CommandSearch::run() {
    const auto* item = list_->currentItem();
    if (!item || !item->data(kEnabledRole).toBool()) return;
    const auto run = all_[std::size_t(item->data(kIndexRole).toInt())].run;
    QWidget* window = parentWidget();
    close();
    // After this is gone: it may open a window of its own.
    QMetaObject::invokeMethod(window, [run] { run(); }, Qt::QueuedConnection);
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
