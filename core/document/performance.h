// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/document/character_input.h"
#include "core/document/effects.h"
#include "core/dynamics/bone_dynamics.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

/// The effects between the kinematic pose and the one that is shown: bone dynamics and the ground. Derived from a document, never saved or undone.
class Performance {
public:
    /// Whether the effects of a document need one at all.
    static bool wanted(const Effects& effects) { return effects.has(EffectKind::BoneDynamics) || effects.has(EffectKind::Ground); }

    /// Milliseconds per frame that one would take while the character swings: by trial of a few frames on this machine.
    static double predict(const Document& document, const CharacterPlan& plan);

    /// Starts at rest. Errors: those of BoneDynamics::build.
    static Result<Performance> build(const Document& document, const CharacterPlan& plan);

    /// Takes over the settings of effects and keeps the motion. Errors: as in build(); then nothing changes.
    Result<void> set(const Effects& effects);

    /// Stops at `kinematic`.
    void reset(const Pose& kinematic);
    /// One frame: the per-frame job. `seconds` > 0.
    void step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals);

    [[nodiscard]] const Pose& pose() const { return dynamics_ ? dynamics_->pose() : raised_; }
    [[nodiscard]] bool isDynamic() const { return dynamics_.has_value(); }
    [[nodiscard]] bool hasGround() const { return ground_.has_value(); }
    [[nodiscard]] bool resting() const { return !dynamics_ || dynamics_->resting(); }
    [[nodiscard]] unsigned warnings() const { return dynamics_ ? dynamics_->warnings() : 0u; }  ///< of DynamicsWarning
    [[nodiscard]] double milliseconds() const { return milliseconds_; }                          ///< wall time of the last step()

private:
    [[nodiscard]] std::optional<BoneDynamicsSettings::Ground> groundOf(const Effects& effects) const;
    [[nodiscard]] BoneDynamicsSettings settingsOf(const Effects& effects) const;
    void raise(const Pose& kinematic);

    Skeleton skeleton_;
    BoneTree tree_;
    std::vector<double> clearance_;  // m, per joint point
    std::optional<BoneDynamicsSettings::Ground> ground_;
    std::optional<BoneDynamics> dynamics_;
    Pose raised_;                    // without dynamics: the kinematic pose, above the ground
    double milliseconds_ = 0.0;
};

}  // namespace imomushi
