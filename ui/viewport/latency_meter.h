// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/live/live_input.h"

namespace imomushi {

/// Measures how long it takes from an input (of the mouse, a controller, the network) to the picture that shows it first.
class LatencyMeter {
public:
    static constexpr std::size_t kKept = 240;  ///< 4 s at 60 Hz
    struct Latency {
        double medianMs = 0.0, p99Ms = 0.0;  ///< of the last kKept
        std::size_t pictures = 0;            ///< that they are of
    };

    /// A move of the pointer that came at one time was given to the performance at another one: moves wait for each other.
    void moved(InputTime came, InputTime given);
    /// The frame that is seen from now on follows an input of this time (Session::Performed::input).
    void shows(InputTime input);
    /// That frame was drawn.
    void painted() { painted_ = firstOf(painted_, std::exchange(shown_, 0)); }
    /// What was drawn is on the screen since `now`. Answers about twice a second, where something was measured.
    std::optional<Latency> swapped(InputTime now);
    /// What was measured until now.
    void forget() { count_ = 0; }
    /// None: nothing was measured.
    [[nodiscard]] std::optional<Latency> latency() const;

private:
    struct Move {
        InputTime came = 0, given = 0;
    } move_;                  // the first one that no frame follows
    InputTime followed_ = 0;  // by a frame
    InputTime shown_ = 0, painted_ = 0;  // since when somebody waits for the next picture, and for the next swap; 0: nobody does
    InputTime answered_ = 0;
    std::array<double, kKept> ms_{};
    std::size_t count_ = 0;   // of all times
};

}  // namespace imomushi
