// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/background_job.h"

#include "ui/models/texts.h"

namespace imomushi {

BackgroundJob::BackgroundJob(QObject* parent) : QObject(parent) {
    timer_.setInterval(50);
    connect(&timer_, &QTimer::timeout, this, &BackgroundJob::poll);
}

BackgroundJob::~BackgroundJob() {
    thread_.request_stop();
    abandoned_.request_stop();
}

void BackgroundJob::launch(std::function<void(const Progress&)> work, std::function<void()> done) {
    cancel();
    shared_ = std::make_shared<Shared>();
    done_ = std::move(done);
    running_ = true;
    stage_.clear();
    fraction_ = 0.0;
    clock_.start();
    thread_ = std::jthread([shared = shared_, work = std::move(work)](std::stop_token stop) {
        work(Progress(
            [&shared](std::string_view stage, double fraction) {
                const std::scoped_lock lock(shared->mutex);
                shared->stage = stage;
                shared->fraction = fraction;
            },
            stop));
        const std::scoped_lock lock(shared->mutex);
        shared->ended = true;
    });
    timer_.start();
}

void BackgroundJob::cancel() {
    if (!running_) return;
    running_ = false;
    timer_.stop();
    thread_.request_stop();
    abandoned_ = std::move(thread_);  // waits for the one before, which was asked to stop long ago
    Q_EMIT finished(false);
}

double BackgroundJob::secondsLeft() const {
    // Before a few per cent are done the rate says nothing.
    if (fraction_ < 0.03) return -1.0;
    return double(clock_.elapsed()) * 1e-3 * (1.0 - fraction_) / fraction_;
}

void BackgroundJob::poll() {
    bool ended = false;
    const auto shared = shared_;
    {
        const std::scoped_lock lock(shared->mutex);
        stage_ = stageText(shared->stage);
        fraction_ = shared->fraction;
        ended = shared->ended;
    }
    Q_EMIT progressed();
    if (!ended || !running_ || shared != shared_) return;  // whoever heard of it may have cancelled it, or begun anew
    running_ = false;
    timer_.stop();
    thread_.join();
    done_();
    Q_EMIT finished(true);
}

}  // namespace imomushi
