// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/status_strip.h"

#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QToolButton>

#include "core/live/live_character.h"
#include "ui/models/body_texts.h"
#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {
constexpr int kWarnedMs = 1500;
constexpr double kSlow = 0.97;  // of real time: less is said
}

StatusStrip::StatusStrip(StudioDocument& document, std::function<std::optional<PrecomputeEstimate>()> estimate, QWidget* parent)
    : QWidget(parent), document_(document), estimate_(std::move(estimate)) {
    setObjectName(QStringLiteral("statusBar"));
    setAttribute(Qt::WA_StyledBackground);
    mouse_ = new QLabel(this);
    hint_ = new ElidedLabel(this);
    state_ = new QToolButton(this);
    state_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    warning_ = named(new QToolButton(this), "frameWarning");
    warning_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    warning_->setFocusPolicy(Qt::NoFocus);
    warning_->hide();
    vertices_ = new QLabel(this);
    ms_ = new QLabel(this);
    fps_ = new QLabel(this);
    latency_ = new QLabel(this);
    for (QLabel* label : {vertices_, ms_, fps_, latency_}) label->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    auto* layout = fill(new QHBoxLayout(this), QMargins(12, 3, 14, 4), Spacing{8}, mouse_, Share{hint_, 1}, warning_, state_);
    for (QLabel* label : {vertices_, ms_, fps_, latency_}) layout->addWidget(label);
    connect(state_, &QToolButton::clicked, this, &StatusStrip::precomputeWanted);
    const auto soon = [this] {
        if (scheduled_) return;
        scheduled_ = true;
        QMetaObject::invokeMethod(this, &StatusStrip::update, Qt::QueuedConnection);
    };
    warned_.setSingleShot(true);
    warned_.setInterval(kWarnedMs);
    connect(&warned_, &QTimer::timeout, this, [this] {
        if (document_.warnings() != warnings_) showWarnings();
    });
    connect(&document, &StudioDocument::frameStepped, this, &StatusStrip::showWarnings);
    connect(&document, &StudioDocument::poseChanged, this, &StatusStrip::showWarnings);
    connect(&document, &StudioDocument::structureChanged, this, soon);
    connect(&document, &StudioDocument::responsesChanged, this, soon);
    connect(&document, &StudioDocument::fileChanged, this, soon);
    connect(&Appearance::instance(), &Appearance::changed, this, soon);
    update();
}

void StatusStrip::setHint(const QString& hint) { hint_->setText(hint); }

QString StatusStrip::hint() const { return hint_->text(); }

void StatusStrip::setFrame(double cpuMs, double fps) {
    lastMs_ = cpuMs;
    lastFps_ = fps;
    showFrame();
    if (const auto s = document_.session().stages()) {
        const QLocale locale;
        const auto ms = [&](double value) { return locale.toString(value, 'f', 3); };
        ms_->setToolTip(tr("Processor time of one frame, with drawing.\nOf that: bones %1 ms, joints %2 ms, surfaces %3 ms, normals %4 ms")
                            .arg(ms(s->pose), ms(s->joints + s->equilibrium), ms(s->product), ms(s->normals)));
    }
}

void StatusStrip::setLatency(const LatencyMeter::Latency& latency) {
    const QLocale locale;
    const auto ms = [&](double value) { return locale.toString(value, 'f', 0); };
    const bool first = latency_->text().isEmpty();
    latencyNow_ = latency;
    latency_->setText(tr("latency %1 ms").arg(ms(latency.medianMs)));
    latency_->setToolTip(tr("From an input (mouse, controller, network) to its picture on the screen: median %1 ms, 99th percentile %2 ms").arg(ms(latency.medianMs), ms(latency.p99Ms)));
    if (first) update();
}

void StatusStrip::showFrame() {
    const QLocale locale;
    vertices_->setText(tr("%1 vertices").arg(locale.toString(verticesOf(document_.document()))));
    ms_->setText(lastMs_ < 0.0 ? QStringLiteral("– ms") : QStringLiteral("%1 ms").arg(locale.toString(lastMs_, 'f', lastMs_ < 10.0 ? 2 : 1)));
    const QString fps = lastMs_ < 0.0 || lastFps_ <= 0.0 ? QStringLiteral("– fps") : QStringLiteral("%1 fps").arg(locale.toString(lastFps_, 'f', 0));
    const double pace = document_.pace();
    const bool slow = pace < kSlow && document_.session().moving();
    fps_->setText(slow ? tr("%1 · slowed to %2 %", "frames per second, share of real time").arg(fps, locale.toString(100.0 * pace, 'f', 0)) : fps);
    fps_->setToolTip(slow ? tr("A step takes longer than its time: time in the performance passes more slowly. Takes keep their times.\nTurn effects off or make bodies simpler to have it in real time.") : QString());
}

void StatusStrip::showWarnings() {
    const unsigned now = document_.warnings();
    if ((now | warnings_) != warnings_ || now == warnings_) {
        if (now) warned_.start();
    } else if (warned_.isActive()) {
        return;  // some of them are gone, which can wait
    }
    if (now == warnings_) return;
    warnings_ = now;
    const auto texts = warningTexts(now);
    warning_->setVisible(!texts.empty());
    if (texts.empty()) return;
    QStringList lines;
    for (const WarningText& text : texts) lines << text.text;
    warning_->setIcon(themedIcon(QStringLiteral("warning"), Appearance::Role::Warning));
    warning_->setIconSize(QSize(px(16), px(16)));
    warning_->setText(fontMetrics().elidedText(lines.front(), Qt::ElideRight, px(430)));
    warning_->setToolTip(lines.join(u'\n'));
    warning_->setAccessibleName(lines.join(u' '));
}

void StatusStrip::setBusy(const QString& text) {
    if (busy_ == text) return;
    busy_ = text;
    update();
}

void StatusStrip::update() {
    scheduled_ = false;
    mouse_->setPixmap(themedIcon(QStringLiteral("mouse"), Appearance::Role::Muted).pixmap(QSize(px(16), px(16)), devicePixelRatioF()));
    state_->setIconSize(QSize(px(16), px(16)));
    setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    // Fixed widths, so that nothing jumps while numbers change.
    ms_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("000.00 ms")) + px(4));
    fps_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("000 fps")) + px(4));
    int stale = 0, all = 0, drafts = 0;
    for (const auto& [id, element] : document_.document().elements) {
        if (element->faces.empty()) continue;
        ++all;
        if (document_.session().responseState(id) != Session::ResponseState::Fresh) ++stale;
        if (document_.session().responses().isDraft(id)) ++drafts;
    }
    state_->setVisible(all > 0 || !busy_.isEmpty());
    if (!busy_.isEmpty()) {
        state_->setIcon(themedIcon(QStringLiteral("precompute"), Appearance::Role::Accent));
        state_->setText(busy_);
    } else if (stale > 0 && stale == drafts) {
        state_->setIcon(themedIcon(QStringLiteral("stale"), Appearance::Role::Muted));
        state_->setText(tr("Soft as a draft"));
        state_->setToolTip(tr("Precompute what is a draft (P)"));
    } else if (stale > 0) {
        state_->setIcon(themedIcon(QStringLiteral("stale"), Appearance::Role::Warning));
        if (const auto cost = estimate_()) {
            state_->setText(tr("%1 of %2 out of date · about %3, %4").arg(stale).arg(all).arg(durationText(cost->seconds), bytesText(cost->bytes)));
            state_->setToolTip(tr("Precompute what is out of date (P): about %1, %2").arg(durationText(cost->seconds), bytesText(cost->bytes)));
        } else {
            state_->setText(tr("%1 of %2 out of date").arg(stale).arg(all));
            state_->setToolTip(tr("Precompute what is out of date (P)"));
        }
    } else {
        state_->setIcon(themedIcon(QStringLiteral("fresh"), Appearance::Role::Good));
        state_->setText(tr("Soft"));
        state_->setToolTip(tr("Precomputed: all elements are up to date"));
    }
    state_->setAccessibleName(tr("State of the precompute: %1").arg(state_->text()));
    // As high with as without the sign of the precompute, in languages with higher letters, too.
    const QMargins around = layout()->contentsMargins();
    setMinimumHeight(std::max(px(32), around.top() + state_->sizeHint().height() + around.bottom()));
    if (!latency_->text().isEmpty()) latency_->setMinimumWidth(fontMetrics().horizontalAdvance(tr("latency %1 ms").arg(QStringLiteral("000"))) + px(4));
    fps_->setToolTip(tr("Frames per second of the viewport"));
    showFrame();
    makeRoom();
}

void StatusStrip::makeRoom() {
    for (QLabel* label : {vertices_, ms_, fps_}) label->show();
    latency_->setVisible(!latency_->text().isEmpty());
    for (QLabel* label : {latency_, vertices_, ms_, fps_})
        if (layout()->activate(), layout()->minimumSize().width() > width()) label->hide();
}

void StatusStrip::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    makeRoom();
}

void StatusStrip::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() != QEvent::LanguageChange) return;
    if (!latency_->text().isEmpty()) setLatency(LatencyMeter::Latency(latencyNow_));
    warnings_ = 0;
    showWarnings();
    update();
}

}  // namespace imomushi
