// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// The motion of a character while its frames are timed: all free ends of its bones but the first are inverse-kinematics targets that oscillate about their rest
/// positions, so that every element deforms in every frame.
struct TestMotion {
    std::vector<IkGoal> goals;
    explicit TestMotion(const Skeleton& skeleton);
    /// Sets the targets to phase t, radians, any.
    void move(double t);

private:
    std::vector<Vec3> rest_;   // of the targets, m
    double amplitude_ = 0.0;   // m: 0.3 of the mean bone length
};

}  // namespace imomushi
