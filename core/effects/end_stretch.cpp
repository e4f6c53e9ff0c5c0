// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/end_stretch.h"

#include <cmath>

#include "core/character/frame.h"
#include "core/effects/body_loads_job.h"

namespace imomushi {

void EndStretchEffect::ask(ElementTables& tables) const { tables.freeEnd = true; }

Result<void> EndStretchEffect::addJob(Frame& frame, FrameJobs& jobs) const {
    jobs.add<BodyLoadsJob>(frame).add(*this);
    return {};
}

Vec3 stretchingLoad(const FreeEnd& end, const Pose& pose, const Eigen::Matrix3d& toElement) {
    const Vec3 along = pose.points[static_cast<std::size_t>(end.end)] - pose.points[static_cast<std::size_t>(end.near)];
    const double length = along.norm(), longer = length - end.length;
    if (length <= 0.0) return Vec3::Zero();
    const double room = end.length * (longer < 0.0 ? EndStretchEffect::kMostShorter : EndStretchEffect::kMostLonger);
    return room * std::tanh(longer / room) / length * (end.perMetre * (toElement * along));
}

}  // namespace imomushi
