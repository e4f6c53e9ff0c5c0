// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/effect_settings.h"

namespace imomushi {

/// Joint dynamics (model.md section 6): the faces of each joint jiggle together about where the pose has them, by nine parameters in the axes of its first
/// face: in-plane stretch, tilts, shifts and twist, as the columns of the basis "affine". Mass and stiffness are those of its elements while their other
/// faces are held.
///   reads   JointFrame::stretch
///   writes  JointFrame::turn, rotation, at; map (its stretch in the plane; not with smooth joints)
struct JointDynamicsEffect : EffectOf<JointDynamicsEffect> {
    static constexpr std::string_view kName = "joint-dynamics";
    double hertz = 4.0;    ///< of the softest way in which a joint jiggles, 0.01 ... 1000
    double damping = 0.2;  ///< ratio, 0 ... 10

    JointDynamicsEffect() = default;
    JointDynamicsEffect(double hertz_, double damping_) : hertz(hertz_), damping(damping_) {}
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

}  // namespace imomushi
