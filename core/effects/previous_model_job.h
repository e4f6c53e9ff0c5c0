// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "core/character/effect_settings.h"
#include "core/joints/joint_face.h"

namespace imomushi {

/// Joint dynamics of the paper's previous model in a character of basis "full" (the manual's model, "The previous model"): every vertex of the joint faces moves by itself about
/// where the bones carry its face, driven by the tractions of the elements, explicitly. Vertices of other faces of a joint do what the nearest one of its
/// first face does, so that seams stay closed. A character does without until all its elements are precomputed for it.
///   warns   Diverged: its joints stand still at their last good place
struct PreviousModelEffect : EffectOf<PreviousModelEffect> {
    static constexpr std::string_view kName = "previous-model";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Previous model");
    static constexpr auto kHelp = IMOMUSHI_TEXT(
        "Effects", "Joint faces move by the explicit dynamics of the paper’s previous model. For comparison: it is slow and may diverge.");
    double step = 1.0 / 600.0;     ///< of the explicit integration, s
    double damping = 4.0;          ///< of velocities, 1/s
    double shearModulus = 3000.0;  ///< of stiffness 1, Pa

    static constexpr auto properties() {
        return std::array{
            number<&PreviousModelEffect::step>("step", "s", 1e-6, 1.0, IMOMUSHI_TEXT("Effects", "Time step"),
                                               IMOMUSHI_TEXT("Effects", "Time step of the explicit integration. Longer ones diverge.")),
            number<&PreviousModelEffect::damping>("damping", "1/s", 0.0, 1e6, IMOMUSHI_TEXT("Effects", "Damping"),
                                                  IMOMUSHI_TEXT("Effects", "Damping of the velocities of joint-face vertices.")),
            number<&PreviousModelEffect::shearModulus>("shear-modulus", "Pa", 1e-3, 1e12, IMOMUSHI_TEXT("Effects", "Shear modulus"),
                                                       IMOMUSHI_TEXT("Effects", "Shear modulus of elements with stiffness 1.")),
        };
    }
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// The area of each vertex of a joint face, m^2: a third of that of its triangles, and at least a thousandth of the mean, so that one without a triangle of its own
/// has some.
std::vector<double> vertexAreas(const TriangleMesh& body, const JointFace& face);

}  // namespace imomushi
