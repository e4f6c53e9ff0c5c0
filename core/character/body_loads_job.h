// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/character/effect_settings.h"
#include "core/character/frame_job.h"
#include "core/character/smoothed_acceleration.h"
#include "core/mesh/mesh.h"

namespace imomushi {

struct ElementFrame;

/// Gravity and inertia: a uniform body force, three columns after v.
struct GravityEffect : EffectOf<GravityEffect> {
    static constexpr std::string_view kName = "gravity";
    Vec3 acceleration = Vec3(0.0, -9.81, 0.0);  ///< of free fall, m/s^2, world
    double inertia = 1.0;                       ///< how much of its own acceleration the flesh feels
    double shearModulus = 3000.0;               ///< of stiffness 1, Pa

    [[nodiscard]] Result<void> validate() const override;
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// Pressure inside elements, one column after v.
struct InflateEffect : EffectOf<InflateEffect> {
    static constexpr std::string_view kName = "inflate";
    double pressure = 0.1;      ///< over the shear modulus of stiffness 1
    double breath = 0.0;        ///< amplitude of its rise and fall
    double breathHertz = 0.25;

    [[nodiscard]] Result<void> validate() const override;
    void ask(ElementTables& tables) const override;
    [[nodiscard]] Result<void> addJob(Frame& frame, FrameJobs& jobs) const override;
};

/// The weights of body loads: force per volume and pressure in the frame of each element, and what they put on its joints. One job for both effects, which
/// share a bound: loads are linear, and deform no element by more than kMaxLoaded of its size, approached smoothly.
///   reads   ElementFrame::frame, rotation
///   writes  ElementFrame::withLoads after v, jointForces (with smooth joints)
///   warns   LoadsBounded
class BodyLoadsJob final : public FrameJob {
public:
    static constexpr double kMaxLoaded = 0.25;

    explicit BodyLoadsJob(const Frame& frame);
    void add(const GravityEffect& gravity) { gravity_ = gravity; }
    void add(const InflateEffect& inflate) { inflate_ = inflate; }

    void run(Stage stage, Frame& frame) override;
    void tune(const EffectSettings& settings) override;
    [[nodiscard]] bool resting(const Frame& frame) const override;
    void report(Frame& frame, double ms) const override;

private:
    struct Element {
        bool gravity = false, inflated = false;
        SmoothedAcceleration acceleration;  // of its middle
    };
    void load(Frame& frame, std::size_t e);

    std::optional<GravityEffect> gravity_;
    std::optional<InflateEffect> inflate_;
    double phase_ = 0.0;  // of the breath, radians
    std::vector<Element> elements_;
};

}  // namespace imomushi
