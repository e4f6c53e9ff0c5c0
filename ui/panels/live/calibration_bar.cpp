// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/panels/live/calibration_bar.h"

#include <QApplication>
#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QToolButton>
#include <algorithm>

#include "core/document/kept_pose.h"
#include "ui/models/mapping_texts.h"
#include "ui/panels/live/state_label.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

QToolButton* smallButton(QWidget* parent, const char* icon) {
    auto* button = new QToolButton(parent);
    button->setProperty("small", true);
    button->setIcon(themedIcon(QLatin1String(icon), Appearance::Role::Muted));
    button->setIconSize(QSize(px(16), px(16)));
    return button;
}

}  // namespace

CalibrationBar::CalibrationBar(StudioDocument& document, InputDeck& inputs, SourceCalibrator& calibrator, QWidget* parent) : QFrame(parent), document_(document), inputs_(inputs), calibrator_(calibrator) {
    choosing_ = new QWidget(this);
    title_ = styled(new QLabel(choosing_), "section");
    pose_ = named(new QComboBox(choosing_), "calibrationPose");
    pose_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    pose_->setMinimumContentsLength(7);
    measure_ = named(new QPushButton(choosing_), "measurePose");
    measure_->setProperty("primary", true);
    close_ = named(smallButton(choosing_, "close"), "closeCalibration");
    auto* top = fill(new QHBoxLayout, Spacing{px(8)}, title_, Share{pose_, 1}, measure_, close_);
    hint_ = named(styled(new QLabel(choosing_), "muted"), "calibrationHint");
    hint_->setWordWrap(true);
    auto* poses = fill(new QHBoxLayout, Spacing{px(14)});
    for (std::size_t i = 0; i < taken_.size(); ++i) {
        Taken& taken = taken_[i];
        const std::string number = std::to_string(i + 1);
        taken.all = new QWidget(choosing_);
        taken.says = named(new QLabel(taken.all), ("calibrated-" + number).c_str());
        taken.clear = named(smallButton(taken.all, "trash"), ("clear-calibrated-" + number).c_str());
        fill(new QHBoxLayout(taken.all), QMargins(0, 0, 0, 0), Spacing{px(2)}, taken.says, taken.clear);
        connect(taken.clear, &QToolButton::clicked, this, [this, i] { calibrator_.clear(source_, taken_[i].pose); });
        poses->addWidget(taken.all);
    }
    poses->addStretch(1);
    trouble_ = named(new QLabel(choosing_), "calibrationTrouble");
    trouble_->setWordWrap(true);
    fill(new QVBoxLayout(choosing_), QMargins(0, 0, 0, 0), Spacing{px(4)}, top, hint_, trouble_, poses);

    counting_ = new QWidget(this);
    countdown_ = named(new QLabel(counting_), "countdown");
    countdown_->setAlignment(Qt::AlignCenter);
    says_ = named(styled(new QLabel(counting_), "title"), "countdownSays");
    says_->setWordWrap(true);
    cancel_ = named(new QPushButton(counting_), "cancelCalibration");
    fill(new QHBoxLayout(counting_), QMargins(0, 0, 0, 0), Spacing{px(16)}, countdown_, Share{says_, 1}, cancel_);
    fill(new QVBoxLayout(this), QMargins(0, px(2), 0, px(4)), choosing_, counting_);

    connect(measure_, &QPushButton::clicked, this, [this] { calibrator_.begin(source_, pose_->currentData().toString().toStdString()); });
    connect(cancel_, &QPushButton::clicked, &calibrator_, &SourceCalibrator::cancel);
    connect(close_, &QToolButton::clicked, this, &CalibrationBar::close);
    connect(&calibrator_, &SourceCalibrator::changed, this, &CalibrationBar::follow);
    connect(&document, &StudioDocument::structureChanged, this, &CalibrationBar::fillPoses);
    connect(&inputs, &InputDeck::changed, this, &CalibrationBar::follow);
    connect(&Appearance::instance(), &Appearance::changed, this, &CalibrationBar::retranslate);
    hide();
    retranslate();
}

void CalibrationBar::open(const std::string& source) {
    if (source == source_) return;
    calibrator_.cancel();
    calibrator_.forgetTrouble();
    source_ = source;
    show();
    retranslate();
    Q_EMIT opened(true);
}

void CalibrationBar::close() {
    if (!isOpen()) return;
    source_.clear();
    calibrator_.cancel();
    qApp->removeEventFilter(this);
    hide();
    Q_EMIT opened(false);
}

void CalibrationBar::fillPoses() {
    const QVariant was = pose_->currentData();
    {
        const QSignalBlocker quiet(pose_);
        pose_->clear();
        pose_->addItem(poseText({}), QString());
        for (const KeptPose& pose : keptPoses(document_.document())) pose_->addItem(poseText(pose.name), QString::fromStdString(pose.name));
    }
    pose_->setCurrentIndex(std::max(0, pose_->findData(was)));
    follow();
}

void CalibrationBar::follow() {
    if (!isOpen()) return;
    const auto& all = inputs_.sources();
    const auto source = std::ranges::find(all, source_, &InputDeck::Source::name);
    const bool can = source != all.end() && calibrator_.canCalibrate(*source);
    if (!can && calibrator_.posesOf(source_).empty()) return close();
    const bool idle = calibrator_.state() == SourceCalibrator::State::Idle || calibrator_.source() != source_;
    choosing_->setVisible(idle);
    counting_->setVisible(!idle);
    qApp->removeEventFilter(this);
    if (!idle) qApp->installEventFilter(this);
    const auto poses = calibrator_.posesOf(source_);
    for (std::size_t i = 0; i < taken_.size(); ++i) {
        Taken& taken = taken_[i];
        taken.all->setVisible(i < poses.size());
        if (i >= poses.size()) continue;
        taken.pose = poses[i].pose;
        const QString name = poseText(taken.pose);
        const QString off = residualText(poses[i].off);
        taken.says->setText(off.isEmpty() ? tr("%1: nothing of it is mapped", "a pose").arg(name) : tr("%1: off by %2", "a pose").arg(name, off));
        taken.clear->setToolTip(tr("Forget what was measured in this pose"));
        taken.clear->setAccessibleName(tr("Forget %1", "a pose").arg(name));
    }
    hint_->setVisible(poses.size() < 2);
    measure_->setEnabled(can);
    showState(*trouble_, calibrator_.trouble(), true);
    if (idle) return;
    const bool counts = calibrator_.state() == SourceCalibrator::State::Counting;
    countdown_->setText(counts ? QString::number(calibrator_.secondsLeft()) : QStringLiteral("●"));
    says_->setText(counts ? tr("Take the pose “%1” …").arg(poseText(calibrator_.pose())) : tr("Hold it …"));
}

void CalibrationBar::retranslate() {
    // Read by who stands a few steps away.
    QFont font = this->font();
    font.setPointSizeF(6.0 * font.pointSizeF());
    font.setBold(true);
    countdown_->setMinimumWidth(QFontMetrics(font).horizontalAdvance(QStringLiteral("00")));
    countdown_->setFont(font);
    const auto source = std::ranges::find(inputs_.sources(), source_, &InputDeck::Source::name);
    const bool first = source != inputs_.sources().end() && source_ == protocolName(source->protocol);  // no other one has its protocol's name
    title_->setText(tr("Calibrate %1", "a source").arg(first ? protocolText(source->protocol) : QString::fromStdString(source_)));
    hint_->setText(tr("Stand as the character does in a pose, and hold still. One pose is met exactly; two or three that differ also tell how much."));
    pose_->setAccessibleName(tr("Pose"));
    measure_->setText(tr("Measure"));
    measure_->setMinimumHeight(measure_->minimumSizeHint().height());  // letters of another language may be higher
    measure_->setToolTip(tr("Counts down from three, and measures what the source says for half a second."));
    cancel_->setText(tr("Cancel"));
    close_->setToolTip(tr("Close"));
    close_->setAccessibleName(tr("Close"));
    fillPoses();
}

// Escape stops the countdown, wherever the focus is.
bool CalibrationBar::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress)
        if (const auto* key = static_cast<const QKeyEvent*>(event); key->key() == Qt::Key_Escape && key->modifiers() == Qt::NoModifier && isActiveWindow() && !QApplication::activeModalWidget() && !QApplication::activePopupWidget()) {
            if (event->type() == QEvent::KeyPress) calibrator_.cancel();
            event->accept();
            return true;
        }
    return QFrame::eventFilter(watched, event);
}

void CalibrationBar::changeEvent(QEvent* event) {
    QFrame::changeEvent(event);
    if (event->type() == QEvent::LanguageChange) retranslate();
}

}  // namespace imomushi
