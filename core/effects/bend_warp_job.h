// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/effect_settings.h"

namespace imomushi {

/// Elements keep their volume under large motions (core/warp/bend_warp.h): their shape is that of the warp instead of the product A' v, or where it
/// is automatic, as much of it as the pose calls for.
struct BendWarpEffect : EffectOf<BendWarpEffect> {
    static constexpr std::string_view kName = "bend-warp";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Bend warp");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Strong bends and twists keep their volume and do not fold.");
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

}  // namespace imomushi
