// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/replay_bar.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"
#include "ui/window/replay_flow.h"

namespace imomushi {

ReplayBar::ReplayBar(ReplayFlow& replay, QWidget* parent) : QFrame(parent), replay_(replay) {
    setObjectName(QStringLiteral("card"));
    title_ = named(new ElidedLabel(this), "replayTitle");
    last_ = styled(new ElidedLabel(this), "muted");
    bar_ = new QProgressBar(this);
    bar_->setTextVisible(false);
    pause_ = named(new QPushButton(this), "replayPause");
    stop_ = named(new QPushButton(this), "replayStop");
    connect(pause_, &QPushButton::clicked, this, [this] { replay_.setPaused(!replay_.paused()); });
    connect(stop_, &QPushButton::clicked, &replay_, &ReplayFlow::stop);
    auto* words = fill(new QVBoxLayout, Spacing{px(2)}, title_, last_);
    auto* top = fill(new QHBoxLayout, Spacing{px(8)}, Share{words, 1}, pause_, stop_);
    fill(new QVBoxLayout(this), QMargins(px(14), px(10), px(12), px(12)), Spacing{px(8)}, top, bar_);
    connect(&replay_, &ReplayFlow::changed, this, &ReplayBar::follow);
    follow();
}

void ReplayBar::follow() {
    title_->setText(tr("How “%1” was built: %2 of %3").arg(replay_.title()).arg(replay_.done()).arg(replay_.count()));
    last_->setText(replay_.last());
    bar_->setRange(0, replay_.count());
    bar_->setValue(replay_.done());
    bar_->setAccessibleName(title_->text());
    pause_->setText(replay_.paused() ? tr("Go on") : tr("Pause"));
    stop_->setText(tr("Stop"));
    setVisible(replay_.running());
}

void ReplayBar::changeEvent(QEvent* event) {
    QFrame::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) follow();
}

}  // namespace imomushi
