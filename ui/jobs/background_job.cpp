// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/background_job.h"

#include <utility>

#include "ui/models/failures.h"
#include "ui/models/texts.h"

namespace imomushi {
namespace {
constexpr int kPollMs = 50, kProgressMs = 200;
}

BackgroundJob::BackgroundJob(QObject* parent) : QObject(parent) {
    timer_.setInterval(kPollMs);
    connect(&timer_, &QTimer::timeout, this, &BackgroundJob::poll);
}

BackgroundJob::~BackgroundJob() {
    thread_.request_stop();
}

void BackgroundJob::launch(std::function<void(const Progress&)> work, std::function<void()> done, std::function<void()> failed) {
    cancel();
    const auto shared = std::make_shared<Shared>();
    thread_ = std::jthread([shared, work = std::move(work), before = std::move(abandoned_)](std::stop_token stop) mutable {
        before = {};
        std::exception_ptr failure;
        try {
            work(Progress(
                [&shared](std::string_view stage, double fraction) {
                    const std::scoped_lock lock(shared->mutex);
                    shared->stage = stage;
                    shared->fraction = fraction;
                },
                stop));
        } catch (...) {
            failure = std::current_exception();
        }
        const std::scoped_lock lock(shared->mutex);
        shared->failure = std::move(failure);
        shared->ended = true;
    });
    shared_ = shared;
    done_ = std::move(done);
    failed_ = std::move(failed);
    running_ = true;
    stage_.clear();
    fraction_ = 0.0;
    clock_.start();
    told_.invalidate();
    timer_.start();
}

void BackgroundJob::cancel() {
    if (!running_) return;
    running_ = false;
    timer_.stop();
    thread_.request_stop();
    abandoned_ = std::move(thread_);  // there is none of before: this thread waits for that
    Q_EMIT finished(false);
}

double BackgroundJob::secondsLeft() const {
    // Before a few per cent are done the rate says nothing.
    if (fraction_ < 0.03) return -1.0;
    return double(clock_.elapsed()) * 1e-3 * (1.0 - fraction_) / fraction_;
}

void BackgroundJob::poll() {
    bool ended = false;
    std::exception_ptr failure;
    const auto shared = shared_;
    {
        const std::scoped_lock lock(shared->mutex);
        stage_ = stageText(shared->stage);
        fraction_ = shared->fraction;
        ended = shared->ended;
        failure = shared->failure;
    }
    takeDone();
    const auto current = [&] { return running_ && shared == shared_; };  // whoever heard of it may have cancelled it, or begun anew
    if (!current()) return;
    if (!told_.isValid() || told_.hasExpired(kProgressMs) || ended) {
        told_.start();
        Q_EMIT progressed();
    }
    if (!ended || !current()) return;
    running_ = false;
    timer_.stop();
    thread_.join();
    const auto doneNow = std::move(done_), failedNow = std::move(failed_);  // they may launch again
    if (failure) Failures::instance().note(failure);
    const bool completed = !failure && attempt(doneNow);
    if (!completed && failedNow) attempt(failedNow);
    Q_EMIT finished(completed);
    if (!completed) Failures::instance().say();
}

}  // namespace imomushi
