// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/viewport/frame_clock.h"

#include <algorithm>

namespace imomushi {
namespace {

/// The camera keeps to the clock also where drawing is slow, but a view never changes in less than two pictures.
constexpr double kLongestTurn = 0.12;

}  // namespace

FrameClock::FrameClock(CameraController& camera, FrameMeter& meter) : camera_(camera), meter_(meter) {
    timer_.setTimerType(Qt::PreciseTimer);
    timer_.setSingleShot(true);
    connect(&timer_, &QTimer::timeout, this, &FrameClock::tick);
}

void FrameClock::start() {
    if (timer_.isActive() || !moving()) return;
    sinceTick_.start();
    timer_.start(1000 / kMostHertz);
}

void FrameClock::swapped() {
    if (!timer_.isActive()) return;
    const qint64 left = 1000 / kMostHertz - sinceTick_.elapsed();
    if (left > 0) timer_.start(int(left));
    else tick();
}

void FrameClock::tick() {
    const double passed = double(sinceTick_.nsecsElapsed()) * 1e-9;
    sinceTick_.start();
    camera_.advance(std::min(kLongestTurn, passed));
    QElapsedTimer work;
    work.start();
    if (playing()) deck_->advance(passed);
    meter_.addWork(elapsedMs(work));
    if (moving()) timer_.start(kHiddenMs);
    else timer_.stop();
    Q_EMIT ticked();
}

}  // namespace imomushi
