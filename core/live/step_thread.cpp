// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/step_thread.h"

namespace imomushi {

StepThread::StepThread(std::function<bool(double)> step) : step_(std::move(step)), clock_(60.0), thread_([this] { serve(); }) {}

StepThread::~StepThread() {
    {
        const std::lock_guard lock(mutex_);
        running_ = false;
        closing_ = true;
    }
    asked_.notify_one();
    thread_.join();
}

void StepThread::run(double hertz) {
    {
        const std::lock_guard lock(mutex_);
        if (running_) return;
        running_ = true;
        if (clock_.seconds() != 1.0 / hertz) {
            clock_.setRate(hertz);
            rested_ = true;
        }
        // In time with the steps before: hands that pull stop it often, and must not put off the next step each time.
        if (rested_) clock_.begin(std::chrono::steady_clock::now());
        rested_ = false;
    }
    asked_.notify_one();
}

void StepThread::park() {
    std::unique_lock lock(mutex_);
    running_ = false;
    asked_.notify_one();
    left_.wait(lock, [this] { return !inside_; });
}

void StepThread::serve() {
    std::unique_lock lock(mutex_);
    while (!closing_) {
        asked_.wait(lock, [this] { return running_ || closing_; });
        inside_ = true;
        while (running_) {
            if (asked_.wait_until(lock, clock_.next(), [this] { return !running_; })) break;
            for (int due = clock_.due(std::chrono::steady_clock::now()); due > 0 && running_; --due) {
                lock.unlock();
                const bool more = step_(clock_.seconds());
                lock.lock();
                rested_ = !more;
                running_ = running_ && more;
            }
            leftOut_.store(clock_.leftOut(), std::memory_order_relaxed);
        }
        inside_ = false;
        left_.notify_all();
    }
}

}  // namespace imomushi
