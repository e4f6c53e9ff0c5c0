// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/skeleton/skeleton.h"

namespace imomushi {

struct StandardPose {
    std::string name;
    Pose pose;
};

/// The poses that models are compared in: "stretch" (all bones by a fifth), "bend" (30 degrees at every joint, in one plane), "twist" (20 degrees of roll
/// from joint to joint), and three of random stretches, bends and rolls, the same for a skeleton every time. Roots stay in place.
std::vector<StandardPose> standardPoses(const Skeleton& skeleton);

}  // namespace imomushi
