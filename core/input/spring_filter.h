// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

namespace imomushi {

/// A number that hangs on another one by a spring: it follows late, swings beyond and comes to rest there.
struct Spring {
    double hertz = 0.0;     ///< how fast it swings; 0: no spring
    double damping = 0.4;   ///< ratio, kLeastDamping ... 1: does not swing beyond
    static constexpr double kLeastDamping = 0.05;
    bool operator==(const Spring&) const = default;
};

class SprungNumber {
public:
    void restart(double value) { value_ = value, speed_ = 0.0; }
    /// It stands where its goal was in the last step.
    [[nodiscard]] bool rests() const { return speed_ == 0.0; }
    /// A step of so many seconds towards `goal`: the exact motion of a damped oscillator, so that any step is stable and steps of any length agree.
    double follow(double goal, double seconds, const Spring& spring) {
        if (!(spring.hertz > 0.0)) {
            speed_ = 0.0;
            return value_ = goal;
        }
        const double w = 2.0 * std::numbers::pi * spring.hertz, z = spring.damping, away = value_ - goal, fades = std::exp(-z * w * seconds);
        if (z < 1.0) {
            const double swing = w * std::sqrt(1.0 - z * z), c = std::cos(swing * seconds), s = std::sin(swing * seconds) / swing;
            value_ = goal + fades * (away * c + (speed_ + z * w * away) * s);
            speed_ = fades * (speed_ * c - (w * w * away + z * w * speed_) * s);
        } else {
            const double pull = speed_ + w * away;
            value_ = goal + fades * (away + pull * seconds);
            speed_ = fades * (speed_ - w * pull * seconds);
        }
        // What is nearly there is there, so that a performance comes to rest.
        if (std::abs(value_ - goal) + std::abs(speed_) / w < kRest * (1.0 + std::abs(goal))) restart(goal);
        return value_;
    }

private:
    static constexpr double kRest = 1e-7;
    double value_ = 0.0, speed_ = 0.0;
};

}  // namespace imomushi
