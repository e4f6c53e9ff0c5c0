// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/takes_panel.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QListView>
#include <QLocale>
#include <QMenu>
#include <QPainter>
#include <QPushButton>
#include <QToolButton>
#include <algorithm>

#include "ui/models/texts.h"
#include "ui/panels/time_bar.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/list_keys.h"
#include "ui/widgets/line_delegate.h"
#include "ui/widgets/wrapping_layout.h"

namespace imomushi {
namespace {

constexpr int kNarrow = 480;  // a panel with less has no room for the key on the button

}  // namespace

TakesPanel::TakesPanel(StudioDocument& document, TakeDeck& deck, ActionSet& actions, QWidget* parent)
    : QWidget(parent), document_(document), deck_(deck), actions_(actions) {
    usePanelBackground(this);
    model_ = new TakeModel(document, this);
    record_ = named(new QPushButton(this), "recordButton");
    record_->setFocusPolicy(Qt::TabFocus);
    connect(record_, &QPushButton::clicked, actions["record"], &QAction::trigger);
    connect(actions["record"], &QAction::changed, this, [this] { record_->setEnabled(actions_["record"]->isEnabled()); });
    const auto button = [&](const char* action, QBoxLayout* row) {
        auto* b = new QToolButton(this);
        b->setDefaultAction(actions[action]);
        b->setFocusPolicy(Qt::TabFocus);
        row->addWidget(b);
        buttons_.push_back(b);
        return b;
    };

    list_ = new QListView(this);
    list_->setModel(model_);
    list_->setItemDelegate(new LineDelegate({TakeModel::IconRole, TakeModel::NoteRole}, {}, list_));
    list_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed);
    list_->setUniformItemSizes(true);
    list_->setMouseTracking(true);
    list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    list_->setContextMenuPolicy(Qt::CustomContextMenu);
    list_->installEventFilter(this);
    connect(list_->selectionModel(), &QItemSelectionModel::currentChanged, this, [this](const QModelIndex& now) {
        if (!following_ && now.isValid()) deck_.choose(model_->take(now));
    });
    // A click on the take that is chosen already shows it too.
    connect(list_, &QListView::clicked, this, [this](const QModelIndex& index) { deck_.choose(model_->take(index)); });
    connect(list_, &QListView::customContextMenuRequested, this, [this](const QPoint& at) { menu(list_->viewport()->mapToGlobal(at)); });
    connect(model_, &QAbstractItemModel::modelAboutToBeReset, this, [this] { following_ = true; });
    connect(model_, &QAbstractItemModel::modelReset, this, [this] {
        following_ = false;
        follow();
    });

    empty_ = styled(new QLabel(this), "muted");
    empty_->setWordWrap(true);
    empty_->setAlignment(Qt::AlignLeft | Qt::AlignTop);

    clips_ = named(new QToolButton(this), "fromClip");
    clips_->setDefaultAction(actions["take-clip"]);
    clips_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    clips_->setFocusPolicy(Qt::TabFocus);
    buttons_.push_back(clips_);
    connect(actions["take-clip"], &QAction::changed, this, &TakesPanel::showClips);

    // Buttons that belong together stay on one line.
    const auto group = [&](std::initializer_list<const char*> ids) {
        auto* all = new QWidget(this);
        auto* row = fill(new QHBoxLayout(all), QMargins(0, 0, 0, 0), Spacing{2});
        for (const char* id : ids) button(id, row);
        return all;
    };
    transport_ = new QWidget(this);
    auto* transport = new WrappingLayout(transport_);
    transport->addWidget(group({"take-back", "play", "take-forward", "loop"}));
    transport->addWidget(group({"mark-in", "mark-out", "trim-take"}));
    auto* when = group({"take-clip"});
    moreClips_ = buttons_.back();
    clock_ = new ElidedLabel(this);
    clock_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Preferred);
    fill(static_cast<QHBoxLayout*>(when->layout()), Space{10}, clock_);
    transport->addWidget(when);
    auto* state = new QWidget(this);
    note_ = styled(new QLabel(this), "warning");
    auto* stateRow = fill(new QHBoxLayout(state), QMargins(10, 0, 0, 0), Spacing{2}, Share{note_, 1});
    live_ = button("leave-take", stateRow);
    live_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    live_->setProperty("small", true);
    transport->addWidget(state);

    bar_ = new TimeBar(this);
    connect(bar_, &TimeBar::wanted, this, [this](int frame) {
        if (const Take* take = deck_.take()) deck_.show(take->times[std::size_t(frame)]);
    });
    connect(bar_, &TimeBar::spanWanted, &deck_, &TakeDeck::setSpan);

    records_ = new QWidget(this);
    auto* recordRow = fill(new QHBoxLayout(records_), QMargins(0, 0, 0, 0), Spacing{2}, Share{record_, 1}, Space{4});
    button("count-in", recordRow);
    takeButtons_ = group({"rename-take", "duplicate-take", "remove-take"});
    static_cast<QHBoxLayout*>(takeButtons_->layout())->addStretch();
    left_ = new QWidget(this);
    auto* above = new QWidget(left_);
    auto* aboveRow = new WrappingLayout(above);
    for (QWidget* part : {records_, takeButtons_}) aboveRow->addWidget(part);
    auto* left = fill(new QVBoxLayout(left_), QMargins(0, 0, 0, 0), Spacing{6}, above, Share{list_, 1});
    left->addStretch();  // the button stays where it is while there is no list
    auto* right = fill(new QVBoxLayout, Spacing{4}, empty_, Share{clips_, 0, Qt::AlignLeft}, transport_, bar_, Stretch{});
    fill(new QHBoxLayout(this), QMargins(10, 8, 12, 8), Spacing{14}, left_, Share{right, 1});

    connect(&deck_, &TakeDeck::changed, this, &TakesPanel::follow);
    connect(&document_, &StudioDocument::structureChanged, this, &TakesPanel::follow);
    connect(&Appearance::instance(), &Appearance::changed, this, &TakesPanel::takeSizes);
    takeSizes();
    retranslate();
}

void TakesPanel::takeSizes() {
    record_->setIconSize(QSize(px(24), px(16)));
    empty_->setContentsMargins(0, px(8), 0, 0);
    empty_->setMinimumWidth(px(120));
    shareWidth();
    list_->setMinimumHeight(px(36));
    for (auto* b : buttons_) b->setIconSize(QSize(px(20), px(20)));
    live_->setIconSize(QSize(px(16), px(16)));
    clock_->setMinimumWidth(px(130));
    askForHeight();
    dressed_.reset();
    follow();
}

void TakesPanel::shareWidth() {
    const int share = model_->rowCount() > 0 ? width() / 3 : width() * 2 / 5;
    const int least = std::max(px(width() < px(kNarrow) ? 150 : 180), records_->minimumSizeHint().width());  // its words and its key
    left_->setFixedWidth(std::clamp(share, least, std::max(least, px(290))));
}

void TakesPanel::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    dressRecord();
    shareWidth();
    askForHeight();
}

bool TakesPanel::event(QEvent* event) {
    const bool done = QWidget::event(event);
    if (event->type() == QEvent::LayoutRequest) askForHeight();
    return done;
}

// The list asks for more than it needs, and would be scrolled to.
int TakesPanel::heightForWidth(int width) const { return layout()->totalMinimumHeightForWidth(width); }

void TakesPanel::askForHeight() {
    // Before it is seen its width says nothing, and the dock keeps a height that was once asked for.
    setMinimumHeight(isVisible() ? std::max(px(118), heightForWidth(width())) : px(118));
    Q_EMIT heightWanted(minimumHeight());
}

/// Red says what it does; the words and the sign on it say it too.
void TakesPanel::dressRecord() {
    const bool recording = deck_.recording();
    const std::pair look(recording ? -1 : deck_.counting(), width() < px(kNarrow));
    if (dressed_ == look) return;
    dressed_ = look;
    const QColor red(kRecordRed), panel = themeColor(Appearance::Role::Panel);
    const auto mix = [&](double t) {
        return QColor(int(panel.red() + (red.red() - panel.red()) * t), int(panel.green() + (red.green() - panel.green()) * t),
                      int(panel.blue() + (red.blue() - panel.blue()) * t)).name();
    };
    const QString ink = recording ? QStringLiteral("#ffffff") : themeColor(Appearance::Role::Text).name();
    record_->setStyleSheet(QStringLiteral("QPushButton { background: %1; border: 1px solid %2; border-radius: %3px; color: %4; font-weight: 600; min-height: %5px; padding: 2px 12px; }"
                                          "QPushButton:hover { background: %6; } QPushButton:focus { border-color: %4; } QPushButton:disabled { background: transparent; color: %7; border-color: %8; }")
                               .arg(mix(recording ? 1.0 : 0.16), mix(recording ? 1.0 : 0.55))
                               .arg(px(8)).arg(ink).arg(px(26))
                               .arg(mix(recording ? 0.85 : 0.3), themeColor(Appearance::Role::Muted).name(), themeColor(Appearance::Role::Line).name()));
    QPixmap sign(QSize(px(24), px(16)) * devicePixelRatioF());  // with room before the words
    sign.setDevicePixelRatio(devicePixelRatioF());
    sign.fill(Qt::transparent);
    QPainter painter(&sign);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(recording ? QColor(Qt::white) : red);
    const QRectF all(0, 0, px(16), px(16));
    if (recording) painter.drawRoundedRect(all.adjusted(px(2), px(2), -px(2), -px(2)), px(2), px(2));
    else painter.drawEllipse(all.adjusted(1, 1, -1, -1));
    painter.end();
    record_->setIcon(QIcon(sign));
    const QString keys = actions_["record"]->shortcut().toString(QKeySequence::NativeText);
    const QString text = recording ? tr("Stop recording") : deck_.counting() ? tr("Starts in %1 s – stop", "a recording").arg(deck_.counting()) : tr("Record");
    if (look.second) record_->setText(recording ? tr("Stop", "recording, where there is little room") : text);
    else record_->setText(keys.isEmpty() ? text : QStringLiteral("%1  (%2)").arg(text, keys));
    record_->setAccessibleName(text);
}

void TakesPanel::follow() {
    if (following_) return;
    following_ = true;
    const Take* take = deck_.take();
    const auto recording = document_.session().recording();
    const bool any = model_->rowCount() > 0 || recording;
    dressRecord();
    list_->setVisible(model_->rowCount() > 0);
    takeButtons_->setVisible(model_->rowCount() > 0 && !recording && !deck_.counting());  // then the button for recording says more
    empty_->setVisible(!any);
    transport_->setVisible(any);
    shareWidth();
    bar_->setVisible(any);
    showClips();
    if (!any)
        empty_->setText(deck_.canRecord() ? tr("No takes yet. Press Record and drag the character: all that you see is kept, until you press it again.")
                                          : tr("What you perform is recorded here. Open a sample or import a mesh first."));

    const QModelIndex row = take ? model_->indexOf(take->id) : QModelIndex();
    if (row != list_->currentIndex()) list_->setCurrentIndex(row);
    list_->setEnabled(!recording);

    const auto found = recording ? document_.document().takes.end() : document_.document().takes.find(take ? take->id : 0);
    const std::shared_ptr<const Take> now = found == document_.document().takes.end() ? nullptr : found->second;
    if (now != barTake_) {
        barTake_ = now;
        bar_->setTimes(now ? now->times : std::vector<double>());
    }
    bar_->setRecorded(recording ? recording->seconds : -1.0);
    if (now) {
        bar_->setSpan(deck_.from(), deck_.to());
        bar_->setTime(deck_.time());
    }
    const QLocale locale;
    if (!take || recording) clock_->setRoomFor({});
    if (recording) {
        clock_->setText(tr("%1 · %2 · frame %3", "take, time, frame").arg(QString::fromStdString(recording->take), clockText(recording->seconds), locale.toString(qulonglong(recording->frames))));
    } else if (take) {
        const auto at = [&](double time, qulonglong frame) {
            return tr("%1 / %2 · frame %3 of %4", "time, length, frame, frames").arg(clockText(time), clockText(take->duration()), locale.toString(frame), locale.toString(qulonglong(take->times.size())));
        };
        clock_->setText(at(deck_.time(), qulonglong(deck_.frame() + 1)));
        clock_->setRoomFor(at(take->duration(), take->times.size()));
    } else {
        clock_->clear();
    }
    const bool changed = deck_.shown() && !deck_.exact();
    note_->setText(changed ? tr("Recorded on another version: pose only") : QString());
    note_->setToolTip(changed ? tr("The character has changed since the recording. The take shows its poses, without effects.") : QString());
    live_->setVisible(deck_.shown());
    following_ = false;
}

void TakesPanel::showClips() {
    const bool there = actions_["take-clip"]->isEnabled();
    clips_->setVisible(there && empty_->isVisibleTo(this));
    moreClips_->setVisible(there);
}

void TakesPanel::rename() {
    if (list_->currentIndex().isValid()) list_->edit(list_->currentIndex());
}

void TakesPanel::menu(const QPoint& global) {
    if (!list_->currentIndex().isValid()) return;
    QMenu menu(this);
    menu.addAction(actions_["play"]);
    menu.addSeparator();
    for (const char* action : {"rename-take", "duplicate-take", "trim-take", "remove-take"}) menu.addAction(actions_[action]);
    menu.exec(global);
}

bool TakesPanel::eventFilter(QObject* watched, QEvent* event) {
    if (watched == list_ && takeListKey(*event, [this] { deck_.remove(); })) return true;
    return QWidget::eventFilter(watched, event);
}

void TakesPanel::retranslate() {
    list_->setAccessibleName(tr("Takes"));
    bar_->setAccessibleName(tr("Time"));
    bar_->setToolTip(tr("Drag to any moment; arrow keys go frame by frame. The marks below say which part is played, and which part trimming keeps."));
    dressed_.reset();
    model_->refresh();
    follow();
}

void TakesPanel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
