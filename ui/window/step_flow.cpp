// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/step_flow.h"

#include <utility>

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
        Q_EMIT changed();
        Q_EMIT cancelled();
    });
}

void StepFlow::start(Wish wish) {
    waiting_.push_back(std::move(wish));
    if (waiting_.size() > 1) return;
    tries_ = 0;
    next();
    Q_EMIT changed();
}

void StepFlow::cancel() {
    if (job_.running()) return job_.cancel();
    later_.stop();
    if (waiting_.empty()) return;
    waiting_.clear();
    Q_EMIT changed();
}

void StepFlow::next() {
    ++tries_;
    job_.start(document_, waiting_.front().command, waiting_.front().arrange);
}

void StepFlow::finish() {
    if (busy_()) return later_.start();
    const std::shared_ptr<const Result<PreparedStep>> made = job_.result();
    if (*made && !(*made)->fits(document_.document()) && tries_ < kMostTries) return next();
    const Wish wish = std::move(waiting_.front());
    waiting_.pop_front();
    if (*made) {
        const auto answer = document_.executePrepared(wish.command, {made, &**made});
        if (answer) wish.done(*answer);
    } else {
        Q_EMIT document_.failed(errorText(made->error()));
    }
    tries_ = 0;
    if (!waiting_.empty()) next();
    Q_EMIT changed();
}

}  // namespace imomushi
