// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include "ui/models/take_deck.h"
#include "ui/viewport/camera_controller.h"
#include "ui/viewport/frame_meter.h"

namespace imomushi {

/// Moves the camera and plays takes, once for each picture that the screen shows. What moves by itself has a clock of its own (Performer).
class FrameClock : public QObject {
    Q_OBJECT
public:
    static constexpr int kMostHertz = 240;  ///< where the screen does not wait
    static constexpr int kHiddenMs = 50;    ///< as often at least, where nothing is drawn

    /// Both must outlive it.
    FrameClock(CameraController& camera, FrameMeter& meter);
    /// Also steps what this plays.
    void follow(TakeDeck& deck) { deck_ = &deck; }
    /// Starts where something moves.
    void start();
    void stop() { timer_.stop(); }
    /// The picture that ticked() asked for is on the screen.
    void swapped();
    [[nodiscard]] bool running() const { return timer_.isActive(); }

Q_SIGNALS:
    void ticked();

private:
    [[nodiscard]] bool playing() const { return deck_ && deck_->playing(); }
    [[nodiscard]] bool moving() const { return camera_.moving() || playing(); }
    void tick();

    CameraController& camera_;
    FrameMeter& meter_;
    TakeDeck* deck_ = nullptr;
    QTimer timer_;
    QElapsedTimer sinceTick_;
};

}  // namespace imomushi
