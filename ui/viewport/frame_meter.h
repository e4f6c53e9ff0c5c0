// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <optional>

namespace imomushi {

/// Measures what frames cost and how fast they follow each other.
class FrameMeter {
public:
    /// Work of the next frame besides drawing: commands and solving.
    void addWork(double ms) { workMs_ += ms; }

    struct Frame {
        double cpuMs = 0.0;  ///< work and drawing
        double fps = 0.0;    ///< smoothed; 0: a single picture
    };
    /// A frame was drawn in `drawMs`; `running`: others follow it. Answers about ten times a second, and always for a single picture.
    std::optional<Frame> drawn(double drawMs, bool running);

private:
    double workMs_ = 0.0;
    double frameSeconds_ = 0.0;  ///< smoothed; 0: not running
    QElapsedTimer lastDrawn_, lastAnswer_;
};

/// Milliseconds since `timer` was started.
inline double elapsedMs(const QElapsedTimer& timer) { return double(timer.nsecsElapsed()) * 1e-6; }

}  // namespace imomushi
