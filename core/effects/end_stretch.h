// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/character/effect_settings.h"
#include "core/mesh/mesh.h"

namespace imomushi {

struct Frame;
struct Pose;

/// Flesh between a joint and the free end of a bone has no second face that would stretch it. This stretches it with its bone, by a uniform force: the first three columns of its loads.
/// It acts on elements that hang on one joint and where the precompute made these columns (BodyLoads::WhereCheap); it asks for none by itself.
struct EndStretchEffect : EffectOf<EndStretchEffect> {
    static constexpr std::string_view kName = "end-stretch";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Stretching ends");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Flesh around the free end of a bone stretches with the bone, so that the end stays inside.");

    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// The force that stretches one element with its bone.
class EndStretch {
public:
    /// Nullopt: no bone ends in the element freely, it has no loads, or a uniform force moves other flesh more than that around the end.
    static std::optional<EndStretch> of(const Frame& frame, std::size_t element);
    /// Force per volume over the shear modulus, 1/m, rest axes of the element: with it, flesh around the end moves as the end does along the bone. By more than kMostLonger or
    /// kMostShorter of the length it moves less, approached smoothly: loads are linear.
    [[nodiscard]] Vec3 load(const Pose& pose) const;

    static constexpr double kMostLonger = 0.8, kMostShorter = 0.4;

    struct Constants {
        int joint = 0, end = 0;  ///< points of the skeleton
        double length = 0.0;     ///< m, between them at rest
        Vec3 perMetre = Vec3::Zero();  ///< load() per metre that the bone is longer, 1/m^2
    };
    [[nodiscard]] const Constants& constants() const { return is_; }

private:
    Constants is_;
};

}  // namespace imomushi
