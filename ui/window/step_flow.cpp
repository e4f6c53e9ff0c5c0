// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/step_flow.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/document/document_change.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {

constexpr int kMostTries = 4;    // then it is done while the window waits: somebody changes the document all the time
constexpr int kGestureMs = 150;  // whether a gesture is over

}  // namespace

StepFlow::StepFlow(StudioDocument& document, std::function<bool()> busy, QObject* parent) : QObject(parent), document_(document), busy_(std::move(busy)) {
    later_.setSingleShot(true);
    later_.setInterval(kGestureMs);
    connect(&later_, &QTimer::timeout, this, &StepFlow::finish);
    connect(&job_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) return finish();
        waiting_.clear();
        tell();
        if (!quiet_) Q_EMIT cancelled();
    });
}

void StepFlow::tell() {
    std::vector<Json> commands;
    for (const Waiting& one : waiting_) std::ranges::move(one.step.commands(), std::back_inserter(commands));
    document_.setUnderWay(std::move(commands));
    Q_EMIT changed();
}

QString StepFlow::title() const {
    if (waiting_.empty()) return {};
    const SlowStep& step = waiting_.front().step;
    return step.title.isEmpty() ? stepText(step.commands().back().at("do").get<std::string>(), {}) : step.title;
}

void StepFlow::start(SlowStep step) {
    waiting_.push_back({std::move(step), document_.session().position()});
    if (waiting_.size() == 1 && !takingOver_) {
        tries_ = 0;
        next();
    }
    tell();
}

void StepFlow::cancel() {
    if (job_.running()) return job_.cancel();
    later_.stop();
    if (waiting_.empty()) return;
    waiting_.clear();
    tell();
    if (!quiet_) Q_EMIT cancelled();
}

void StepFlow::giveUp() {
    quiet_ = true;
    cancel();
    quiet_ = false;
}

void StepFlow::cancelLatest() {
    if (waiting_.size() <= 1) return cancel();
    waiting_.pop_back();
    tell();
    if (!quiet_) Q_EMIT cancelled();
}

void StepFlow::next() {
    ++tries_;
    begun_ = document_.document();
    job_.start(document_, waiting_.front().step);
}

void StepFlow::finish() {
    if (busy_()) return later_.start();
    const std::shared_ptr<const Result<PreparedStep>> made = job_.result();
    const bool fits = differInPoseAtMost(begun_, document_.document());  // a refusal is of that document, too
    if (!fits && tries_ < kMostTries) return next();
    job_.dropResult();
    begun_ = {};
    takingOver_ = true;
    {
        const SlowStep step = std::move(waiting_.front().step);
        waiting_.pop_front();
        if (!fits) {
            document_.executeAtOnce(step);
        } else if (*made) {
            const auto answer = document_.takePrepared(**made);
            if (answer && step.done) step.done(*answer);
        } else if (step.refused) {
            step.refused(made->error());
        } else {
            Q_EMIT document_.failed(errorText(made->error()));
        }
    }
    takingOver_ = false;
    for (Waiting& other : waiting_) other.position = document_.session().position();
    tries_ = 0;
    if (!waiting_.empty()) next();
    tell();
}

}  // namespace imomushi
