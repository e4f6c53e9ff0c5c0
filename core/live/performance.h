// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/document/character_input.h"
#include "core/document/effects.h"
#include "core/dynamics/bone_dynamics.h"
#include "core/project/document_responses.h"

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

    /// Sets the pose to `kinematic` with zero velocity. Without bone dynamics it is raised above the ground at once, and a goal that the ground lifts sets the warning HeldByGround; with bone dynamics `goals` are not used.
    void reset(const Pose& kinematic, std::span<const IkGoal> goals);
    /// Goes on with the motion of bones of another one. False: there is none, or its skeleton is another one, and nothing changes.
    bool takeMotion(const Performance& of);
    /// After reset(): goes on with the motion of the bones that another one had, too. Does nothing where one of them has no bone dynamics.
    void takeMotionOfBones(const Performance& of);
    /// One frame: the per-frame job. `seconds` > 0.
    void step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals);
    /// Takes the flesh near the ground as last shown (groundFlesh() in ground_job.h) and the joint points it was shown with (m, world). The
    /// next step() keeps this flesh above the ground, so the ground reacts one frame late. Does nothing without the effect "ground".
    void seeFlesh(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points);

    /// If the flesh of the last seeFlesh() is deeper in the ground than 0.5 % of the skeleton's size (how far its farthest joint point is from its first one), raises the joint points of pose() until the next step(). False: nothing was raised.
    bool lift();
    /// Translates each connected group of bones and elements up until none of its `depths` exceeds 0.5 % of the skeleton's size (1 % with contact). False: none did.
    bool liftWhole(std::span<const FleshDepth> depths);

    [[nodiscard]] const Pose& pose() const { return dynamics_ && !lifted_ ? dynamics_->pose() : raised_; }
    [[nodiscard]] bool isDynamic() const { return dynamics_.has_value(); }
    [[nodiscard]] bool hasGround() const { return ground_.has_value(); }
    [[nodiscard]] bool resting() const { return dynamics_ ? dynamics_->resting() : held_; }
    /// No flesh is in the ground as it was seen last, or deeper than contact carries.
    [[nodiscard]] bool holdsFlesh() const { return held_; }
    [[nodiscard]] unsigned warnings() const { return dynamics_ ? dynamics_->warnings() : warnings_; }  ///< of DynamicsWarning
    [[nodiscard]] double milliseconds() const { return milliseconds_; }                          ///< wall time of the last step()

private:
    void take(const Effects& effects);
    /// Until the next call.
    const BoneDynamicsSettings& settingsOf(const Effects& effects);
    void follow(const Pose& kinematic, std::span<const IkGoal> goals);
    // A pose, above the ground.
    void raise(const Pose& pose, Pose& raised);

    Skeleton skeleton_;
    std::vector<PartId> bones_;      // of the document, in the order of the skeleton
    double size_ = 0.0;              // of the skeleton, m
    std::optional<BoneDynamicsSettings::Ground> ground_;
    double pressed_ = 0.0;
    BoneDynamicsSettings asked_;     // room of settingsOf()
    std::optional<BoneDynamics> dynamics_;
    std::vector<FleshPoint> flesh_;  // as it presses
    bool held_ = true, lifted_ = false;
    std::optional<FleshClearance> clearing_;
    std::vector<double> clearance_;  // m, per joint point
    std::vector<std::int32_t> wholeOf_;  // per joint point, the lowest one that bones and elements connect it with
    std::vector<double> depthOf_;        // m, per such point
    // Without dynamics: the pose that was given, the pose that is shown, the pose that is shown next. With dynamics raised_ is what lift() made.
    Pose kinematic_, raised_, next_;
    Pose shown_;                     // without dynamics: what the frame before ended with
    int still_ = 0;                  // frames since kinematic_ changed
    unsigned warnings_ = 0;
    double milliseconds_ = 0.0;
};

/// What it costs to have an effect, on or off now: DocumentResponses::costOf(), and of effects on bones a trial of a few frames.
EffectCost effectCost(const Document& document, const DocumentResponses& responses, EffectKind effect);

}  // namespace imomushi
