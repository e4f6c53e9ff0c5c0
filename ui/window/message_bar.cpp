// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/message_bar.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QToolButton>

#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

constexpr int kLeastWords = 120;  // of the width of a text, in pixels of the design
constexpr int kShortWords = 240;  // beside a button

}  // namespace

MessageBar::MessageBar(QWidget* parent) : QFrame(parent) {
    setObjectName(QStringLiteral("toast"));
    icon_ = new QLabel(this);
    text_ = new QLabel(this);
    text_->setWordWrap(true);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    text_->setMinimumWidth(px(kLeastWords));
    action_ = named(new QPushButton(this), "offer");
    action_->hide();
    close_ = new QToolButton(this);
    close_->setProperty("small", true);
    close_->setIcon(themedIcon(QStringLiteral("close"), Appearance::Role::Muted));
    close_->setToolTip(tr("Close"));
    close_->setAccessibleName(tr("Close"));
    words_ = new QBoxLayout(QBoxLayout::LeftToRight);
    words_->setSpacing(px(10));
    words_->addWidget(text_, 1);
    words_->addWidget(action_);
    fill(new QHBoxLayout(this), QMargins(px(14), px(9), px(8), px(9)), Spacing{px(10)}, icon_, Share{words_, 1}, close_);
    connect(action_, &QPushButton::clicked, this, [this] {
        hide();
        if (act_) act_();
    });
    connect(close_, &QToolButton::clicked, this, &QWidget::hide);
    timer_.setSingleShot(true);
    connect(&timer_, &QTimer::timeout, this, &QWidget::hide);
    hide();
}

void MessageBar::say(const QString& text, Tone tone) {
    static constexpr const char* kIcons[] = {"info", "check", "warning"};
    static constexpr Appearance::Role kRoles[] = {Appearance::Role::Info, Appearance::Role::Good, Appearance::Role::Warning};
    icon_->setPixmap(themedIcon(QLatin1String(kIcons[int(tone)]), kRoles[int(tone)]).pixmap(QSize(px(20), px(20)), devicePixelRatioF()));
    text_->setText(text);
    setAccessibleName(text);
    action_->hide();
    act_ = {};
    show();
    raise();
    updateGeometry();
    // Long enough to read: about 15 characters a second.
    timer_.start(tone == Tone::Warning ? int(5000 + 70 * text.size()) : 4000);
}

void MessageBar::offer(const QString& text, const QString& label, std::function<void()> action) {
    say(text, Tone::Info);
    action_->setText(label);
    action_->show();
    act_ = std::move(action);
    updateGeometry();
    timer_.start(int(8000 + 70 * text.size()));
}

void MessageBar::withdraw(const QString& text) {
    if (text_->text() == text) hide();
}

QString MessageBar::text() const { return text_->text(); }

// The button goes below the words where it would leave them too little room.
void MessageBar::resizeEvent(QResizeEvent* event) {
    QFrame::resizeEvent(event);
    const int room = width() - px(14 + 8 + 3 * 10) - icon_->sizeHint().width() - close_->sizeHint().width();
    words_->setDirection(room - action_->sizeHint().width() < px(kShortWords) ? QBoxLayout::TopToBottom : QBoxLayout::LeftToRight);
}

void MessageBar::enterEvent(QEnterEvent*) { timer_.stop(); }
void MessageBar::leaveEvent(QEvent*) { timer_.start(2500); }

void MessageBar::changeEvent(QEvent* event) {
    QFrame::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    close_->setToolTip(tr("Close"));
    close_->setAccessibleName(tr("Close"));
}

}  // namespace imomushi
