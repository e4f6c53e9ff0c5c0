// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/character/effect_settings.h"
#include "core/character/frame.h"
#include "core/character/frame_job.h"
#include "core/effects/end_stretch.h"
#include "core/effects/smoothed_acceleration.h"
#include "core/mesh/mesh.h"

namespace imomushi {

inline constexpr double kEarthGravity = 9.81;  ///< m/s^2

struct ElementState;

/// Gravity and inertia: a uniform body force, three columns after v.
struct GravityEffect : EffectOf<GravityEffect> {
    static constexpr std::string_view kName = "gravity";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Gravity and inertia");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Flesh sags under its weight and lags behind when it is moved.");
    Vec3 acceleration = Vec3(0.0, -kEarthGravity, 0.0);  ///< of free fall, m/s^2, world
    double inertia = 1.0;                       ///< how much of its own acceleration the flesh feels
    static constexpr double kDefaultSag = 0.03;
    double sag = kDefaultSag;                   ///< of the height of a character under the gravity of the Earth, where no shear modulus is given
    double shearModulus = 0.0;                  ///< of stiffness 1, Pa; 0: as `sag` says

    static constexpr auto properties() {
        return std::array{
            number<&GravityEffect::acceleration>("acceleration", "m/s^2", -1e6, 1e6, IMOMUSHI_TEXT("Effects", "Gravity"),
                                                 IMOMUSHI_TEXT("Effects", "Acceleration of free fall, in the world.")),
            number<&GravityEffect::sag>("sag", "", 1e-3, 1.0, IMOMUSHI_TEXT("Effects", "Sag"),
                                        IMOMUSHI_TEXT("Effects", "How far flesh of stiffness 1 sags under Earth’s gravity, as a share of the height of the character.")),
            number<&GravityEffect::shearModulus>(
                "shear-modulus", "Pa", 0.0, 1e12, IMOMUSHI_TEXT("Effects", "Shear modulus"),
                IMOMUSHI_TEXT("Effects", "Shear modulus of flesh of stiffness 1: less is softer, and sags more. It is used instead of “Sag”; 0: “Sag” is used.")),
            number<&GravityEffect::inertia>("inertia", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Inertia"),
                                            IMOMUSHI_TEXT("Effects", "How strongly the flesh lags behind when it is accelerated. 0: not at all.")),
        };
    }
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Per element, Pa: the shear modulus with which its connected elements, were they all of stiffness 1 and standard density, would sag at rest under the gravity
/// of the Earth along -Y by `sag` of their height. 0: no columns of loads.
std::vector<double> modulusForSag(const CharacterInput& input, double sag);

/// Pressure inside elements, one column after v.
struct InflateEffect : EffectOf<InflateEffect> {
    static constexpr std::string_view kName = "inflate";
    static constexpr auto kTitle = IMOMUSHI_TEXT("Effects", "Inflate");
    static constexpr auto kHelp = IMOMUSHI_TEXT("Effects", "Pressure inside puffs the body up, and lets it breathe.");
    double pressure = 0.1;  ///< over the shear modulus of stiffness 1
    double breath = 0.0;    ///< amplitude of its rise and fall
    double breathHertz = 0.25;

    static constexpr auto properties() {
        return std::array{
            number<&InflateEffect::pressure>(
                "pressure", "", -10.0, 10.0, IMOMUSHI_TEXT("Effects", "Pressure"),
                IMOMUSHI_TEXT("Effects", "Pressure over the shear modulus. Above 0 it puffs up, below it shrivels.")),
            number<&InflateEffect::breath>("breath", "", 0.0, 10.0, IMOMUSHI_TEXT("Effects", "Breath"),
                                           IMOMUSHI_TEXT("Effects", "How much the pressure rises and falls with each breath. 0: none.")),
            number<&InflateEffect::breathHertz>("breath-hertz", "Hz", 0.0, 100.0, IMOMUSHI_TEXT("Effects", "Breathing"),
                                                IMOMUSHI_TEXT("Effects", "Breaths per second.")),
        };
    }
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// The weights of body loads: force per volume and pressure in the frame of each element, and what they put on its joints. One job for all their effects. Gravity and pressure
/// share a bound: loads are linear, and deform no element by more than kMaxLoaded of its size, approached smoothly.
///   warns   LoadsBounded
class BodyLoadsJob final : public FrameJob {
public:
    static constexpr double kMaxLoaded = 0.25;

    explicit BodyLoadsJob(const Frame& frame);
    void add(const GravityEffect& gravity);
    void add(const InflateEffect& inflate);
    void add(const EndStretchEffect& stretch) { stretch_ = stretch; }

    void run(Stage stage, Frame& frame) override;
    void tune(const EffectSettings& settings) override;
    [[nodiscard]] bool resting(const Frame& frame) const override;
    void report(Frame& frame, double ms) const override;

private:
    struct Element {
        bool forces = false, pressure = false;  // it has these columns,
        bool gravity = false, inflated = false; // and an effect asked for them
        double modulus = 0.0;               // Pa, for a sag of the whole height
        SmoothedAcceleration acceleration;  // of its middle
    };
    void load(Frame& frame, std::size_t e);

    std::optional<GravityEffect> gravity_;
    std::optional<InflateEffect> inflate_;
    std::optional<EndStretchEffect> stretch_;
    Phase phase_;  // of the breath
    std::vector<Element> elements_;
};

}  // namespace imomushi
