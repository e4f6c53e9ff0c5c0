// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "core/dynamics/bone_dynamics.h"
#include "core/dynamics/bone_springs.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

/// The state and the steps of BoneDynamics: frames in bone_dynamics.cpp, the time integrator in bone_integrator.cpp, contact in ground_contact.cpp.
struct BoneDynamics::State {
    // What one step changes.
    struct Body {
        std::vector<Vec3> x, v;
        std::vector<double> roll, rollRate;
        std::vector<char> contact;          // of Contact
        std::vector<double> normalForce;    // N, of the ground in the last step
        std::vector<Vec3> offset;           // of held points from their kinematic place
        std::vector<double> clearance;      // m: how far points stay above the ground for the flesh around them
    };
    enum Contact : char { kNone, kSliding, kSticking };

    explicit State(Input given);
    /// After the settings changed.
    void prepare();
    void wake();
    /// Height of joint point i at p above its clearance of the ground, m.
    [[nodiscard]] double height(std::size_t i, const Vec3& p) const {
        return settings.ground->plane.height(p) - body.clearance[i];
    }
    [[nodiscard]] Vec3 aboveGround(std::size_t i, const Vec3& p) const {
        if (!settings.ground) return p;
        return p - std::min(height(i, p), 0.0) * normal;
    }
    [[nodiscard]] bool usable(const Pose& pose) const;
    void takeTargets(const Pose& pose, BoneTargets& to) const;
    static void mix(const BoneTargets& a, const BoneTargets& b, double part, BoneTargets& to);
    static bool same(const BoneTargets& a, const BoneTargets& b);
    void reset(const Pose& pose);
    bool takeMotion(const State& of);
    void takeMotion(const State& of, std::span<const int> pointOf);
    [[nodiscard]] double kineticOf(const std::vector<Vec3>& v) const;
    [[nodiscard]] double gravityOf(const std::vector<Vec3>& x) const;
    [[nodiscard]] Energy energyOf(const std::vector<Vec3>& x, const std::vector<Vec3>& v, const BoneTargets& targets) const;
    /// Solves x = x0 + s v, mass (v - v0) / s = forces(x, v) for what is free, beginning near xs; what is prescribed has come `part` of its way through
    /// the step of h seconds.
    bool solveStage(double s, double h, double part, const BoneTargets& targets, const BoneSprings::Motion& motion);
    void stageVelocities(double s, double h);
    /// N s/m: Coulomb's friction as a damper, by the speed at the beginning of the step, so that it never reverses a point.
    [[nodiscard]] double friction(int i) const;
    /// J: kinetic energy of all free points at the speed of the fastest target in this step.
    [[nodiscard]] double followingEnergy(double h) const;
    /// Clearances at the end of the next h seconds.
    void followFlesh(double h);
    /// It lies on the ground, by a contact or held.
    [[nodiscard]] bool touches(std::size_t i) const;
    void seeFlesh(std::span<const FleshPoint> seen, const std::vector<Vec3>& points);
    /// Prescribed points of the next h seconds into `freedom` and `goal`. True: something outside moves.
    bool prescribe(double h);
    /// One step of `h` seconds from `last` to `next`.
    void advance(double h);
    bool solveStages(double h, const BoneSprings::Motion& motion);
    /// Adds points that went through the ground to the contacts. True: there are some.
    bool detectContact();
    /// Contact and friction for the next step, from the reaction forces of this one (Coulomb: sticking while |tangential| <= mu |normal|).
    void updateContact(const BoneSprings::Motion& motion);
    /// Elastic and gravitational energy at the end of the step, into `energy`. Lifts points that went through the ground.
    double potentialEnergy();
    /// Scales velocities so that the energy does not exceed `allowed`.
    void limitEnergy(double allowed);
    void accept(double h);
    void advanceRoll(double h, const BoneSprings::Motion& motion);
    /// Into `out`. Frames are transported along the tree; those of roots by the least rotation from the kinematic pose.
    void writePose(const Body& from, const BoneTargets& targets);
    void step(double seconds, const Pose& target, std::span<const IkGoal> goals);
    [[nodiscard]] bool sameFrames(const Pose& target) const;
    /// Into `next`: the kinematic pose at a part of the frame. Bit for bit the same while it rests.
    void targetsAt(double part);
    void sleep();

    const Skeleton skeleton;
    BoneDynamicsSettings settings;
    std::vector<double> mass;
    BoneSprings springs;
    BlockCholesky<3> system;
    FleshClearance flesh;
    double unit = 0.0;  // mean rest length of the bones, m
    double size = 0.0;  // of the skeleton, m
    Vec3 normal = Vec3::UnitY();
    double weight = 0.0;  // N

    Body body, saved;              // at the last full step; its copy while a part of a step is tried
    BoneTargets last;              // at the last full step
    BoneTargets next, stage;       // at the end of the step, and at its first stage
    BoneTargets frameStart, frameEnd;
    Pose kinematic, out;
    double phase = 0.0;            // s, from the last full step to the end of the last frame
    double remaining = 0.0;        // s, of the frame
    double unseen = 0.0;           // s, since flesh was seen; negative: it is to be seen as it is
    std::vector<char> held, heldNow;
    std::vector<char> pointing, pointingNow;  // per bone: held as it points
    bool resting = false, slow = false;
    bool fleshMoves = false;       // on the ground, in this step
    int slowSteps = 0;
    unsigned warnings = 0;
    Energy energy;
    bool energyKnown = false;

    // Of one step.
    std::vector<Freedom> freedom;
    double stageSeconds = 0.0;     // of its last stage
    std::vector<char> arriving;
    std::vector<char> alone;       // flesh turns as the point follows it, see FleshClearance::find()
    std::vector<double> wanted;    // clearances
    std::vector<Vec3> goal;        // where fixed points are at the end of the step
    std::vector<Vec3> x0, v0, xs, vs, force, change, force0;
    std::vector<double> roll0, rollRate0, rollStage, rollRateStage;
};

/// Whether settings fit a skeleton; what BoneDynamics::build() checks besides. Errors as there.
Result<void> checkSettings(const BoneDynamicsSettings& settings, std::size_t bones);
Result<void> checkInput(const BoneDynamics::Input& input);

}  // namespace imomushi
