// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/source_calibrator.h"

#include <QLocale>
#include <QStringList>
#include <algorithm>
#include <utility>

#include "core/document/document_change.h"
#include "core/document/source_calibration.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

/// How often it looks at the clock, ms.
constexpr int kTickMs = 50;

}  // namespace

SourceCalibrator::SourceCalibrator(StudioDocument& document, InputDeck& inputs, QObject* parent) : QObject(parent), document_(document), inputs_(inputs) {
    timer_.setInterval(kTickMs);
    connect(&timer_, &QTimer::timeout, this, &SourceCalibrator::tick);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        rows_.reset();
        if (change.unknown) stop();  // another project
        Q_EMIT changed();
    });
    connect(&inputs, &InputDeck::changed, this, [this] {
        if (state_ == State::Idle) return;
        const auto& all = inputs_.sources();
        if (std::ranges::none_of(all, [this](const InputDeck::Source& s) { return s.name == source_ && s.open; })) cancel();
    });
}

bool SourceCalibrator::canCalibrate(const InputDeck::Source& source) const {
    return source.open && source.protocol != InputProtocol::Keys && source.protocol != InputProtocol::Voice && document_.session().character() && inputs_.isMapped(source.name);
}

void SourceCalibrator::begin(const std::string& source, const std::string& pose) {
    stop();
    trouble_.clear();
    source_ = source;
    pose_ = pose;
    state_ = State::Counting;
    since_.start();
    timer_.start();
    secondsLeft_ = (countdown_ + 999) / 1000;
    Q_EMIT changed();
}

void SourceCalibrator::stop() {
    timer_.stop();
    inputs_.measure({});
    state_ = State::Idle;
}

void SourceCalibrator::cancel() {
    if (state_ == State::Idle) return;
    stop();
    Q_EMIT changed();
}

void SourceCalibrator::tick() {
    if (state_ == State::Measuring) {
        if (since_.elapsed() >= kMeasureMs) finish();
        return;
    }
    const int left = std::max(0, (countdown_ - int(since_.elapsed()) + 999) / 1000);
    if (left == 0) {
        state_ = State::Measuring;
        inputs_.measure(source_);
        since_.start();
    }
    if (left == std::exchange(secondsLeft_, left) && state_ == State::Counting) return;
    Q_EMIT changed();
}

void SourceCalibrator::finish() {
    const auto measured = inputs_.measured();
    stop();
    const auto& all = inputs_.sources();
    const auto source = std::ranges::find(all, source_, &InputDeck::Source::name);
    // A body says where it is all the time; a fader that nobody moves says nothing.
    const bool silent = source != all.end() && source->protocol == InputProtocol::Vmc && measured && measured->heard() == 0;
    auto said = measured && !silent ? measured->means() : std::map<std::string, std::vector<double>>();
    if (said.empty()) {
        trouble_ = tr("Nothing was heard. Let the source send, and measure again.");
    } else if (const auto answer = document_.execute(commands::calibrateSource(source_, pose_, said), true); !answer) {
        trouble_ = errorText(answer.error());
    }
    Q_EMIT changed();
}

void SourceCalibrator::clear(const std::string& source, const std::string& pose) {
    trouble_.clear();
    document_.execute(commands::clearCalibration(source, pose));
}

std::vector<CalibratedRows::OfPose> SourceCalibrator::posesOf(const std::string& source) const {
    const Document& document = document_.document();
    if (!calibrationOf(document, source) || !document_.session().character()) return {};
    if (!rows_) rows_ = calibratedRows(document, document_.session().plan());
    std::vector<CalibratedRows::OfPose> made;
    for (const CalibratedRows::OfPose& pose : rows_->poses)
        if (pose.source == source) made.push_back(pose);
    return made;
}

CalibrationResidual mostOf(const std::vector<CalibratedRows::OfPose>& poses) {
    CalibrationResidual most;
    for (const CalibratedRows::OfPose& pose : poses)
        for (const auto kind : {&CalibrationResidual::degrees, &CalibrationResidual::mm, &CalibrationResidual::percent})
            if (pose.off.*kind) most.*kind = std::max((most.*kind).value_or(0.0), *(pose.off.*kind));
    return most;
}

QString residualText(const CalibrationResidual& residual) {
    const QLocale locale;
    QStringList parts;
    if (residual.degrees) parts << locale.toString(*residual.degrees, 'f', 1) + QStringLiteral("°");
    if (residual.mm) parts << locale.toString(*residual.mm, 'f', 0) + QStringLiteral(" mm");
    if (residual.percent) parts << locale.toString(*residual.percent, 'f', 0) + QStringLiteral(" %");
    return parts.join(QStringLiteral(", "));
}

QString poseText(const std::string& pose) { return pose.empty() ? SourceCalibrator::tr("Rest", "a pose") : QString::fromStdString(pose); }

}  // namespace imomushi
