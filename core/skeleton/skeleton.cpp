// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/skeleton/skeleton.h"

namespace imomushi {

Pose restPose(const Skeleton& skeleton) {
    Pose pose;
    pose.points = skeleton.points;
    pose.frames.assign(skeleton.bones.size(), Eigen::Quaterniond::Identity());
    pose.roll.assign(skeleton.points.size(), 0.0);
    return pose;
}

}  // namespace imomushi
