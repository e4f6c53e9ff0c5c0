// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>

#include "core/live/step_clock.h"

namespace imomushi {

/// A thread that steps something at a fixed rate while it runs. It is parked at first. Where a step says that nothing moves it sleeps, for as long as that says or until it is woken, and takes no processor time.
class StepThread {
public:
    static constexpr double kUntilWoken = std::numeric_limits<double>::infinity();
    /// `step` makes a step of so many seconds, after so many more, 0 mostly, in which it slept. It answers for how long no other one is needed, s; 0: the next one follows. It must not throw.
    explicit StepThread(std::function<double(double seconds, double slept)> step);
    ~StepThread();
    StepThread(const StepThread&) = delete;
    StepThread& operator=(const StepThread&) = delete;

    /// Makes `hertz` steps a second from now on, in time with those before unless it slept or made others; or sleeps at first, for so many seconds from its last step on or, where it did not sleep, from now on.
    void run(double hertz, double sleep = 0.0);
    /// From any thread: whoever sleeps makes a step at once. Whoever is parked is not woken. Waits for nobody who steps.
    void wake();
    /// Returns when no step is being made, and none is made before run(): waits for one step at most.
    void park();
    /// s of performance that were left out, as steps took longer than their time.
    [[nodiscard]] double leftOut() const { return leftOut_.load(std::memory_order_relaxed); }

private:
    void serve();
    /// Until it is woken or stopped.
    void sleep(std::unique_lock<std::mutex>& lock);
    void beginAnew();

    const std::function<double(double, double)> step_;
    StepClock clock_;
    std::mutex mutex_;
    std::condition_variable asked_, left_;
    bool running_ = false;  // asked for
    bool inside_ = false;   // the thread is where it makes steps
    double sleep_ = kUntilWoken;  // s from sleptSince_ on; 0: it is to step
    std::chrono::steady_clock::time_point sleptSince_ = std::chrono::steady_clock::now();
    double slept_ = 0.0;    // s, before the next step
    std::atomic<bool> asleep_{false}, woken_{false};
    bool closing_ = false;
    std::atomic<double> leftOut_{0.0};
    std::thread thread_;
};

}  // namespace imomushi
