// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/frame_clock.h"

#include <algorithm>

namespace imomushi {
namespace {

/// A frame that took longer than this (a stall, a sleep) moves the scene by no more than this: the most that bone dynamics take in one step.
constexpr double kLongestStep = 0.25;
/// The camera keeps to the clock also where drawing is slow, but a view never changes in less than two pictures.
constexpr double kLongestTurn = 0.12;
/// A pose whose points move less than this part of the scene in a frame has come to rest.
constexpr double kAtRest = 1e-6;

}  // namespace

FrameClock::FrameClock(StudioDocument& document, CameraController& camera, FrameMeter& meter)
    : document_(document), camera_(camera), meter_(meter) {
    timer_.setTimerType(Qt::PreciseTimer);
    timer_.setInterval(kFrameMs);
    connect(&timer_, &QTimer::timeout, this, &FrameClock::tick);
}

// A frame that is stepped leaves the take that is shown, and is what a recording is made of.
bool FrameClock::posing() const {
    const Session& session = document_.session();
    return session.recording() || (!session.showsTake() && (approaching_ || document_.session().moving()));
}

void FrameClock::start() {
    if (timer_.isActive() || !moving()) return;
    sinceTick_.start();
    timer_.start();
}

void FrameClock::poseChanged() {
    if (!stepping_) approaching_ = !document_.document().goals.empty();
}

void FrameClock::stepPose(double seconds) {
    before_ = document_.document().pose.points;
    stepping_ = true;
    document_.stepFrame(seconds);
    stepping_ = false;
    const auto& now = document_.document().pose.points;
    double moved = before_.size() == now.size() ? 0.0 : 1.0, size = 0.0;
    for (std::size_t i = 0; i < now.size() && i < before_.size(); ++i) {
        moved = std::max(moved, (now[i] - before_[i]).norm());
        size = std::max(size, (now[i] - now[0]).norm());
    }
    approaching_ = approaching_ && !(moved <= kAtRest * size);
}

void FrameClock::tick() {
    Q_EMIT aboutToStep();
    const double passed = double(sinceTick_.nsecsElapsed()) * 1e-9;
    sinceTick_.start();
    camera_.advance(std::min(kLongestTurn, passed));
    QElapsedTimer work;
    work.start();
    if (playing())
        deck_->advance(passed);
    else if (posing())
        stepPose(std::min(kLongestStep, passed));
    meter_.addWork(elapsedMs(work));
    Q_EMIT ticked();
    if (!moving()) timer_.stop();
}

}  // namespace imomushi
