// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace imomushi {

/// Which steps of a fixed length are due. Late steps are caught up, four at once at most; a longer delay is skipped, so that the performance becomes slower instead of lagging more and more.
class StepClock {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Duration = std::chrono::steady_clock::duration;
    static constexpr int kMostAtOnce = 4;

    explicit StepClock(double hertz) { setRate(hertz); }
    /// `hertz` > 0: steps per second. begin() must follow.
    void setRate(double hertz) { length_ = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / hertz)), seconds_ = 1.0 / hertz; }
    /// s, of one step.
    [[nodiscard]] double seconds() const { return seconds_; }
    /// The first step is due at once.
    void begin(Time now) { next_ = now; }
    /// When the next step is due.
    [[nodiscard]] Time next() const { return next_; }
    /// How many steps are due now, 0 ... kMostAtOnce. They count as made.
    int due(Time now);
    /// So many of them were not made after all: they are due again.
    void putBack(int steps) { next_ -= steps * length_; }
    /// s that were left out, in all.
    [[nodiscard]] double leftOut() const { return std::chrono::duration<double>(leftOut_).count(); }

private:
    Duration length_{};
    double seconds_ = 0.0;
    Time next_{};
    Duration leftOut_{};
};

}  // namespace imomushi
