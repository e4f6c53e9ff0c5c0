// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>
#include <vector>

#include "ui/models/take_deck.h"
#include "ui/viewport/camera_controller.h"
#include "ui/viewport/frame_meter.h"

namespace imomushi {

/// Steps frames at 60 Hz while something moves: the camera, a take that plays, or the pose, which follows held points, moves by itself or is recorded.
class FrameClock : public QObject {
    Q_OBJECT
public:
    static constexpr int kFrameMs = 16;

    /// All must outlive it.
    FrameClock(StudioDocument& document, CameraController& camera, FrameMeter& meter);
    /// Also steps what this plays.
    void follow(TakeDeck& deck) { deck_ = &deck; }
    /// Starts where something moves.
    void start();
    void stop() { timer_.stop(); }
    [[nodiscard]] bool running() const { return timer_.isActive(); }
    /// A command changed the pose: the skeleton follows what is held. Nothing to do where the clock itself stepped it.
    void poseChanged();

Q_SIGNALS:
    void aboutToStep();  ///< emitted at the start of each tick, before the frame is stepped: apply pending input now
    void ticked();

private:
    [[nodiscard]] bool playing() const { return deck_ && deck_->playing(); }
    [[nodiscard]] bool posing() const;
    [[nodiscard]] bool moving() const { return camera_.moving() || posing() || playing(); }
    void tick();
    void stepPose(double seconds);

    StudioDocument& document_;
    CameraController& camera_;
    FrameMeter& meter_;
    TakeDeck* deck_ = nullptr;
    QTimer timer_;
    QElapsedTimer sinceTick_;
    bool approaching_ = false;  ///< the kinematic pose still moves towards what is held
    bool stepping_ = false;
    std::vector<Vec3> before_;
};

}  // namespace imomushi
