// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "core/character/effect_settings.h"

namespace imomushi {

/// Joint dynamics (the manual's effects): the faces of each joint jiggle together about where the pose has them, by nine parameters in the axes of its first
/// face: in-plane stretch, tilts, shifts and twist, as the columns of the basis "affine". Mass and stiffness are those of its elements while their other
/// faces are held.
struct JointDynamicsEffect : EffectOf<JointDynamicsEffect> {
    static constexpr std::string_view kName = "joint-dynamics";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Joint dynamics");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Joints jiggle softly after each move.");
    double hertz = 4.0;    ///< of the softest way in which a joint jiggles
    double damping = 0.2;  ///< ratio

    JointDynamicsEffect() = default;
    JointDynamicsEffect(double hertz_, double damping_) : hertz(hertz_), damping(damping_) {}
    static constexpr auto properties() {
        return std::array{
            number<&JointDynamicsEffect::hertz>("hertz", "Hz", 0.01, 1000.0, IMOMUSHI_TEXT("Effects", "Jiggle"),
                                                IMOMUSHI_TEXT("Effects", "How fast the softest part of a joint jiggles.")),
            number<&JointDynamicsEffect::damping>("damping", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Damping"),
                                                  IMOMUSHI_TEXT("Effects", "Damping ratio. 0: it never stops; 1: no jiggle.")),
        };
    }
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

}  // namespace imomushi
