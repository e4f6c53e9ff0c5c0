// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/effect_settings.h"
#include "core/character/free_end.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// Flesh around the free end of a bone has no joint face there that would stretch it. This stretches it with its bone, by a uniform force: the first three columns of its loads.
/// It acts where freeEndOf() finds one, and asks for no precompute: the columns are there where they are cheap (BodyLoads::WhereCheap).
struct EndStretchEffect : EffectOf<EndStretchEffect> {
    static constexpr std::string_view kName = "end-stretch";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Stretching ends");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Flesh around the free end of a bone stretches with the bone, so that the end stays inside.");
    /// Of the length of the bone. By more the flesh moves less than the end, approached smoothly: loads are linear.
    static constexpr double kMostLonger = 0.8, kMostShorter = 0.4;

    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// The force that moves flesh around the end as far along the bone as that is longer than at rest, or shorter: see FreeEnd::perMetre. `toElement`: from the world to the axes of the element.
Vec3 stretchingLoad(const FreeEnd& end, const Pose& pose, const Eigen::Matrix3d& toElement);

}  // namespace imomushi
