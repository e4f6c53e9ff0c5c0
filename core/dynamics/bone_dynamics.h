// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/plane.h"
#include "core/base/result.h"
#include "core/dynamics/flesh_clearance.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// The spring-dampers of a bone. Frequencies in Hz are those of the lighter side of the character, rigid but for this spring, against what is held; 0.01 (a
/// slow sway) ... 1000 (looks rigid), usual are 1 ... 10. Damping ratios 0 (oscillates for ever) ... 10; 0.2 overshoots a few times, 1 is critical.
struct BoneSpring {
    double stretchHertz = 5.0, stretchDamping = 0.4;  ///< of its length
    double bendHertz = 2.5, bendDamping = 0.3;      ///< of the bend angle to its parent bone, or to the pose where it starts at a held point
    double rollHertz = 3.0, rollDamping = 0.3;        ///< of its twist about itself

    static constexpr double kMinHertz = 0.01, kMaxHertz = 1000.0, kMaxDamping = 10.0;
};

/// Everything that may change while a character moves.
struct BoneDynamicsSettings {
    std::vector<BoneSpring> springs = {BoneSpring{}};  ///< one for all bones, or one per bone
    /// A tree of bones with no held point is drawn back to the kinematic pose as by critically damped springs of this frequency in Hz, at most
    /// BoneSpring::kMaxHertz; 0: it floats, flies and falls freely (what `ground` wants).
    double returnHertz = 0.5;
    /// Of a tree with a held point, 1/s, 0 ... kMaxAirDamping: how fast points lose their speed beside the kinematic pose. Springs hardly damp the slow sway of a whole body; this does: its
    /// amplitude halves in 1.4 s over this.
    double airDamping = 0.0;
    static constexpr double kMaxAirDamping = 100.0;
    Vec3 gravity = Vec3::Zero();  ///< m/s^2
    /// A plane that no joint point crosses, nor the flesh around it (seeFlesh()), held ones included: they stay in front of it.
    struct Ground {
        Plane plane;
        double friction = 0.6;  ///< Coulomb's coefficient, 0 ... 10
    };
    std::optional<Ground> ground;
};

/// Things that a step wants to say without failing; they describe the last step().
enum class DynamicsWarning : unsigned {
    InputRefused = 1,   ///< a time, pose or goal was not usable: the frame was skipped, or the goal ignored
    TimeDropped = 2,    ///< the frame lasted longer than kMaxSeconds: the rest of its time passed without motion
    StepRefused = 4,    ///< the equations had no finite solution: the last good state stays and its velocities are zero
    HeldByGround = 8,   ///< a point is held above its kinematic place, which is in the ground
};

/// Bone dynamics, step 2 of the paper (the manual's model, "Bones"): every joint point has an equation of motion; its forces come from the lengths of its bones
/// and the angles between them, measured against the kinematic pose that inverse kinematics gives. Held points are prescribed: they move with the
/// kinematic pose.
///
/// Length: the potential k L^2 (r - 1/r)^2 / 8, r = length / kinematic length L, whose frequency does not depend on the amplitude and which no
/// finite force collapses; beyond the stretch limits of the bone a stiff spring beside it. Angle: k theta^2 / 2 between a bone and where its parent carries it; at a held point every bone is measured against its own
/// kinematic direction instead. Beyond limits of bend and twist, and where a goal holds a direction, springs of 60 Hz. Stiff bones have frequencies higher by the
/// square root of their stiffness. Damping acts on the rates of the same lengths and angles, relative to the kinematic pose's.
/// Roll is one linear spring per bone between the rolls of its joint points. Angles are compared in space with those of the kinematic pose: a tree
/// that flies freely and is bent at rest feels a torque back to the kinematic orientation; a straight one does not.
///
/// Time passes in steps of kStep by a stiffly accurate, L-stable, second-order method (Alexander, "Diagonally implicit Runge-Kutta methods for stiff
/// ODEs", 1977), so that motion does not depend on the frame rate and no stiffness is unstable; a frame that ends within a step is closed by a part of
/// a step that is not kept. Energy never grows but by work from outside: moved goals, a moving kinematic pose, changed goals or settings.
class BoneDynamics {
public:
    struct Input {
        Skeleton skeleton;
        std::vector<double> mass;  ///< kg per joint point, > 0; counted as at least 1e-6 of the heaviest
        BoneDynamicsSettings settings;
    };
    /// Starts at rest. Errors: "bad-value" (masses, settings), "bone-loop" (bones that are no forest), "bad-place" (points that are not there).
    static Result<BoneDynamics> build(Input input);
    BoneDynamics(BoneDynamics&&) noexcept;
    BoneDynamics& operator=(BoneDynamics&&) noexcept;
    ~BoneDynamics();

    /// Replaces the settings and keeps the motion. Errors as in build(); then nothing changes.
    Result<void> set(const BoneDynamicsSettings& settings);

    /// Stops at `pose`, from where the kinematic pose then moves on. One that does not fit counts as the pose of rest.
    void reset(const Pose& pose);

    /// Goes on with the motion of another one, whose masses and settings may differ. False: its skeleton is another one, and nothing changes.
    bool takeMotion(const BoneDynamics& of);
    /// Goes on with the motion of one with another skeleton, after reset(). pointOf: per joint point the one that it was there, -1: it is new. What was there stays where it is, but
    /// for how far its place of rest was moved, and is as fast; new ends of bones go along with their starts.
    void takeMotion(const BoneDynamics& of, std::span<const int> pointOf);

    static constexpr double kStep = 1.0 / 240.0;       ///< s
    static constexpr double kMaxSeconds = 0.25;       ///< s, of motion per step()
    /// One frame: `seconds` pass (>= 0), in which the kinematic pose moves evenly from the last one to `kinematic` and the points of `goals` are held.
    /// A point that is newly held approaches its kinematic place within about a fifth of a second. Targets of goals do not count, the kinematic
    /// pose does. Neither allocates, locks nor fails.
    void step(double seconds, const Pose& kinematic, std::span<const IkGoal> goals);

    /// The flesh that the ground meets, as it is shown with these joint points: until it is seen again it turns with its bones. Wakes what rests where flesh comes
    /// to or off the ground. Allocates as FleshClearance::see().
    void seeFlesh(std::span<const FleshPoint> flesh, const std::vector<Vec3>& points);

    /// The pose at the end of the last frame.
    [[nodiscard]] const Pose& pose() const;
    /// Nothing moves until the kinematic pose, the goals or the settings change: pose() stays as it is, bit for bit, and step() costs nothing. Where
    /// neither gravity nor ground keep it away, pose() then is the kinematic pose itself.
    [[nodiscard]] bool resting() const;
    [[nodiscard]] unsigned warnings() const;  ///< of DynamicsWarning

    /// In joules, of points that are not held, at the last full step.
    struct Energy {
        double kinetic = 0.0;
        double elastic = 0.0;  ///< lengths, angles and the return of what is not held
        double gravity = 0.0;  ///< relative to the pose of rest
        [[nodiscard]] double total() const { return kinetic + elastic + gravity; }
    };
    [[nodiscard]] Energy energy() const;
    [[nodiscard]] const std::vector<Vec3>& velocities() const;  ///< m/s per joint point, at the last full step

private:
    struct State;
    explicit BoneDynamics(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
