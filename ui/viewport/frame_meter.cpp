// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/frame_meter.h"

#include <utility>

namespace imomushi {
namespace {

constexpr int kAnswerMs = 100;
/// Pictures farther apart (in seconds) are not counted as frames of one movement.
constexpr double kLongestFrame = 1.0;

}  // namespace

std::optional<FrameMeter::Frame> FrameMeter::drawn(double drawMs, bool running) {
    const double cpuMs = std::exchange(workMs_, 0.0) + drawMs;
    const double seconds = lastDrawn_.isValid() ? double(lastDrawn_.nsecsElapsed()) * 1e-9 : kLongestFrame;
    if (!running || seconds >= kLongestFrame)
        frameSeconds_ = 0.0;
    else
        frameSeconds_ = frameSeconds_ > 0.0 ? 0.9 * frameSeconds_ + 0.1 * seconds : seconds;
    lastDrawn_.start();
    if (lastAnswer_.isValid() && lastAnswer_.elapsed() < kAnswerMs && running) return std::nullopt;
    lastAnswer_.start();
    return Frame{cpuMs, frameSeconds_ > 0.0 ? 1.0 / frameSeconds_ : 0.0};
}

}  // namespace imomushi
