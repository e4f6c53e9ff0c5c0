// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/effect_settings.h"

namespace imomushi {

/// Joint dynamics of the paper's previous model in a character of basis "full" (model.md section 2): every vertex of the joint faces moves by itself about
/// where the bones carry its face, driven by the tractions of the elements, explicitly. Vertices of other faces of a joint do what the nearest one of its
/// first face does, so that seams stay closed. A character does without until all its elements are precomputed for it.
///   reads   JointFrame::turn; ElementFrame::frame
///   writes  ElementFrame::v; Frame::offsets
///   warns   Diverged: its joints stand still at their last good place
struct PreviousModelEffect : EffectOf<PreviousModelEffect> {
    static constexpr std::string_view kName = "previous-model";
    double step = 1.0 / 600.0;     ///< of the explicit integration, s
    double damping = 4.0;          ///< of velocities, 1/s
    double shearModulus = 3000.0;  ///< of stiffness 1, Pa

    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

}  // namespace imomushi
