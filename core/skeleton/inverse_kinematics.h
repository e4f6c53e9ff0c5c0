// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Inverse kinematics on any forest with any number of held points and stretchable bones: a local minimum, near the last pose, of the elastic energy of
/// the bones (RodEnergy) with held points at their targets, or as near as the stretch limits allow.
///
/// Method: implicit Euler steps of the overdamped motion  viscosity dx/dt = -grad energy,  linearised by Gauss-Newton. Each step is thus a
/// Levenberg-Marquardt step (Nocedal and Wright, Numerical Optimization, 2006, section 10.3) with the viscosity as its damping, followed by a line search.
/// A trust region around the pose at which a target last moved bounds the motion: its radius is kMotionGain times the move of the target plus kTrustRadius
/// mean bone lengths, also over many solve() with the same goals, so that a small drag never makes a body jump to a distant minimum.
/// Constants are those of 1/60 s: a shorter or longer frame has its part of them, so that a drag goes the same way at any rate.
/// A straight chain between two held points that is pushed along its axis squashes before it folds (AxialSquash).
/// Without goals nothing moves. Allocates in its constructor only.
class InverseKinematics {
public:
    explicit InverseKinematics(const Skeleton& skeleton);
    InverseKinematics(InverseKinematics&&) noexcept;
    InverseKinematics& operator=(InverseKinematics&&) noexcept;
    ~InverseKinematics();

    /// After a target moved, no joint point moves farther than this times the largest move of a target ...
    static constexpr double kMotionGain = 3.0;
    /// ... plus this times the mean rest length of the bones, until a target moves again: room in which a bent or compressed body releases energy. While
    /// held points have not arrived and still approach their targets, the radius grows by as much in every 1/60 s.
    static constexpr double kTrustRadius = 0.03;
    static constexpr double kUsualFrame = 1.0 / 60.0;  ///< s

    struct Report {
        bool converged = true;      ///< another solve() would not change the pose
        double largestMiss = 0.0;   ///< m, largest distance of a held point from its target
        bool outOfReach = false;    ///< converged with a held point away from its target: stretch or bend limits keep it there
        bool finite = true;         ///< false: refused, the last good pose stays
    };
    /// One frame of so many seconds: moves `pose` towards the goals (of two at one joint point the later counts). Targets must be finite.
    /// One longer than 1/15 s counts as that: more of it would have room for a jump.
    /// A held point without a roll keeps the roll it has; between held points roll is harmonic along the bones.
    /// A pose that does not fit the skeleton counts as the pose of rest.
    Report solve(const std::vector<IkGoal>& goals, Pose& pose, double seconds = kUsualFrame);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
