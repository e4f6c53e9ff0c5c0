// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "core/live/step_clock.h"

namespace imomushi {

/// A thread that steps something at a fixed rate while it runs. It is parked at first, and whenever a step says that all has come to rest: then it takes no processor time.
class StepThread {
public:
    /// `step` makes a step of so many seconds; false: everything has come to rest. It must not throw.
    explicit StepThread(std::function<bool(double seconds)> step);
    ~StepThread();
    StepThread(const StepThread&) = delete;
    StepThread& operator=(const StepThread&) = delete;

    /// Makes `hertz` steps a second from now on, in time with those before unless it came to rest or made others.
    void run(double hertz);
    /// Returns when no step is being made, and none is made before run(): waits for one step at most.
    void park();
    /// s of performance that were left out, as steps took longer than their time.
    [[nodiscard]] double leftOut() const { return leftOut_.load(std::memory_order_relaxed); }

private:
    void serve();

    const std::function<bool(double)> step_;
    StepClock clock_;
    std::mutex mutex_;
    std::condition_variable asked_, left_;
    bool running_ = false;  // asked for
    bool inside_ = false;   // the thread is where it makes steps
    bool rested_ = true;    // since the last step: the clock begins anew
    bool closing_ = false;
    std::atomic<double> leftOut_{0.0};
    std::thread thread_;
};

}  // namespace imomushi
