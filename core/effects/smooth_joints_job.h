// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/effect_settings.h"

namespace imomushi {

/// Joints take the shape that balances their elements (joint_equilibrium.h) instead of the in-plane stretch of lateral contraction (lateral_contraction.h). Not beside the previous model, which shapes joints
/// itself.
struct SmoothJointsEffect : EffectOf<SmoothJointsEffect> {
    static constexpr std::string_view kName = "smooth-joints";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Smooth joints");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Joints take the shape of least energy: bends without a crease.");
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

}  // namespace imomushi
