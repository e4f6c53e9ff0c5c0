// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/character/effect_settings.h"
#include "core/character/free_end.h"
#include "core/mesh/mesh.h"

namespace imomushi {

struct Frame;
struct Pose;

/// Flesh around the free end of a bone has no joint face there that would stretch it. This stretches it with its bone, by a uniform force: the first three columns of its loads.
/// It acts on elements with one free end (freeEndOf()) and where the precompute made these columns (BodyLoads::WhereCheap); it asks for none by itself.
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
    /// Force per volume over the shear modulus, 1/m, in the rest axes of the element: with it, flesh around the end moves as far along the bone as that is longer than at rest, or shorter. By more
    /// than kMostLonger or kMostShorter of its length it moves less, approached smoothly: loads are linear. `toElement`: from the world to these axes.
    [[nodiscard]] Vec3 load(const Pose& pose, const Eigen::Matrix3d& toElement) const;

    static constexpr double kMostLonger = 0.8, kMostShorter = 0.4;

    struct Constants {
        FreeEnd at;
        double length = 0.0;  ///< m, of the bone at rest
        Eigen::Matrix3d perMetre = Eigen::Matrix3d::Zero();  ///< load() per metre that flesh around the end moves, 1/m^2
    };
    [[nodiscard]] const Constants& constants() const { return is_; }

private:
    Constants is_;
};

}  // namespace imomushi
