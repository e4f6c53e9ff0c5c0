// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/mesh/mesh.h"

namespace imomushi {

/// The acceleration of a moving place, as flesh feels it: that of a critically damped follower, which smooths what frames leave out. The place moves
/// evenly within each frame, for which the follower is advanced exactly: the frame rate hardly matters and no frame is too long.
class SmoothedAcceleration {
public:
    static constexpr double kHertz = 6.0;  ///< of the follower: faster shakes are not felt

    void reset(const Vec3& place);
    /// `seconds` > 0 pass, in which the place moves to `place` (m).
    void step(double seconds, const Vec3& place);

    [[nodiscard]] const Vec3& value() const { return acceleration_; }  ///< m/s^2
    [[nodiscard]] bool resting() const { return resting_; }            ///< value() is zero and stays so until the place moves

private:
    Vec3 place_ = Vec3::Zero(), follower_ = Vec3::Zero(), speed_ = Vec3::Zero(), acceleration_ = Vec3::Zero();
    bool resting_ = true;
};

}  // namespace imomushi
