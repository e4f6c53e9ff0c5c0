// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/step_thread.h"

#include <algorithm>
#include <utility>

namespace imomushi {

namespace {

/// s: a longer sleep is one until it is woken, as no clock can count it.
constexpr double kLongestSleep = 1e6;

}  // namespace

StepThread::StepThread(std::function<double(double, double)> step) : step_(std::move(step)), clock_(60.0), thread_([this] { serve(); }) {}

StepThread::~StepThread() {
    {
        const std::lock_guard lock(mutex_);
        running_ = false;
        closing_ = true;
    }
    asked_.notify_one();
    thread_.join();
}

void StepThread::run(double hertz, double sleep) {
    {
        const std::lock_guard lock(mutex_);
        if (running_) return;
        running_ = true;
        const bool other = clock_.seconds() != 1.0 / hertz;
        if (other) clock_.setRate(hertz);
        // In time with the steps before: hands that pull stop it often, and must not put off the next step each time.
        if (sleep > 0.0) {
            if (sleep_ == 0.0) sleptSince_ = std::chrono::steady_clock::now();
            sleep_ = sleep;
        } else if (sleep_ > 0.0) {
            beginAnew();
        } else if (other) {
            clock_.begin(std::chrono::steady_clock::now());
        }
    }
    asked_.notify_one();
}

void StepThread::beginAnew() {
    const auto now = std::chrono::steady_clock::now();
    slept_ = std::max(0.0, std::chrono::duration<double>(now - sleptSince_).count() - clock_.seconds());
    sleep_ = 0.0;
    clock_.begin(now);
}

// Either the sleeper sees what was set, or who sets it sees the sleeper.
void StepThread::wake() {
    woken_ = true;
    if (!asleep_) return;
    { const std::lock_guard lock(mutex_); }
    asked_.notify_one();
}

void StepThread::sleep(std::unique_lock<std::mutex>& lock) {
    const auto disturbed = [this] { return !running_ || woken_; };
    asleep_ = true;
    if (sleep_ <= kLongestSleep) asked_.wait_until(lock, sleptSince_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(sleep_)), disturbed);
    else asked_.wait(lock, disturbed);
    asleep_ = false;
    if (running_) beginAnew();
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
            if (sleep_ > 0.0) {
                sleep(lock);
                continue;
            }
            if (asked_.wait_until(lock, clock_.next(), [this] { return !running_; })) break;
            int due = clock_.due(std::chrono::steady_clock::now());
            for (; due > 0 && running_ && sleep_ == 0.0; --due) {
                woken_ = false;  // what was said until now is seen by this step
                const double slept = std::exchange(slept_, 0.0);
                lock.unlock();
                const double sleep = step_(clock_.seconds(), slept);
                lock.lock();
                sleep_ = sleep;
                sleptSince_ = std::chrono::steady_clock::now();
            }
            // Whoever parked it lets it make the others later, or their time is said to be left out.
            clock_.putBack(due);
            leftOut_.store(clock_.leftOut(), std::memory_order_relaxed);
        }
        inside_ = false;
        left_.notify_all();
    }
}

}  // namespace imomushi
