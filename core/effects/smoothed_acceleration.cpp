// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/effects/smoothed_acceleration.h"

#include <cmath>
#include <numbers>

namespace imomushi {

namespace {
constexpr double kOmega = 2.0 * std::numbers::pi * SmoothedAcceleration::kHertz;
constexpr double kNothing = 1e-4;  // m/s^2: less is not felt
}  // namespace

void SmoothedAcceleration::reset(const Vec3& place) {
    place_ = follower_ = place;
    speed_.setZero();
    acceleration_.setZero();
    resting_ = true;
}

// f'' = w^2 (p - f) - 2 w f'. With p = p0 + s t the follower runs 2 s / w behind; what it is away from that, z, decays as (z0 + (z0' + w z0) t) exp(-w t).
void SmoothedAcceleration::step(double seconds, const Vec3& place) {
    if (!(seconds > 0.0) || (resting_ && place == place_)) return;
    const Vec3 s = (place - place_) / seconds, behind = 2.0 / kOmega * s;
    const Vec3 z = follower_ - (place_ - behind), dz = speed_ - s, slope = dz + kOmega * z;
    const double decay = std::exp(-kOmega * seconds);
    const Vec3 z1 = decay * (z + seconds * slope), dz1 = decay * (dz - kOmega * seconds * slope);
    follower_ = z1 + place - behind;
    speed_ = dz1 + s;
    acceleration_ = -kOmega * kOmega * z1 - 2.0 * kOmega * dz1;
    const bool still = place == place_;
    place_ = place;
    resting_ = false;
    if (still && acceleration_.norm() < kNothing && kOmega * speed_.norm() < kNothing) reset(place);
}

}  // namespace imomushi
