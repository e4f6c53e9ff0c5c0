// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "core/base/block_cholesky.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

struct BoneSpring;

/// What the springs of bones pull towards at one moment: the kinematic pose.
struct BoneTargets {
    std::vector<Vec3> points;     ///< per joint point, m
    std::vector<double> length;   ///< per bone, m, > 0
    std::vector<Vec3> direction;  ///< per bone, unit
    std::vector<double> roll;     ///< per joint point, radians
    std::vector<Vec3> unbent;     ///< per bone, unit: its direction at rest as its parent carries it; empty where no bone limits its bend
};

/// Whether a joint point may move in an implicit step.
enum class Freedom : char { Free, OnPlane, Fixed };

/// The springs and dampers between the joint points of a skeleton: energy, forces and their derivatives (see BoneDynamics). Allocates in its
/// constructor only.
class BoneSprings {
public:
    /// mass: kg per joint point, > 0. The bones must form a forest.
    BoneSprings(const Skeleton& skeleton, const std::vector<double>& mass);

    /// Stiffness and damping from frequencies and damping ratios, with the reduced masses that these held points leave. springs: one or one per bone.
    /// pointing: per bone, whether it is held in its kinematic direction, too; such bones end at held points.
    void calibrate(std::span<const BoneSpring> springs, double returnHertz, double airDamping, const std::vector<char>& held, const std::vector<char>& pointing);

    /// J, at joint points x.
    [[nodiscard]] double energy(const std::vector<Vec3>& x, const BoneTargets& targets) const;

    /// How the targets move during a step: from, to and the seconds between them; null: they rest.
    struct Motion {
        const BoneTargets* from = nullptr;
        const BoneTargets* to = nullptr;
        double seconds = 1.0;
    };
    /// Adds the forces of springs and dampers at positions x and velocities v to `force` (N per joint point). With `system` it adds
    /// -d force / d x - d force / d v / seconds to it, made positive semidefinite, between points that are not fixed; for those on the plane with that
    /// unit `normal` only within the plane.
    void forces(const std::vector<Vec3>& x, const std::vector<Vec3>& v, const BoneTargets& targets, const Motion& motion, std::vector<Vec3>& force,
                BlockCholesky<3>* system, double seconds, const std::vector<Freedom>& freedom, const Vec3& normal);

    /// Pairs of joint points that `system` couples.
    [[nodiscard]] const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }
    [[nodiscard]] const BoneTree& tree() const { return tree_; }
    /// Some bone limits its bend: targets need `unbent`.
    [[nodiscard]] bool limitsBends() const { return !stops_.empty(); }

    /// Implicit Euler step of the rolls, which are linear springs along the bones, in linear time: solves (inertia / s^2 + damping / s + stiffness) roll = right
    /// side of `predicted` rolls and rates, s = seconds. `roll` in: prescribed where `held`.
    void solveRoll(const BoneTargets& targets, const Motion& motion, double seconds, const std::vector<double>& predicted,
                   const std::vector<double>& predictedRate, const std::vector<char>& held, std::vector<double>& roll);

private:
    struct SpringDamper {
        double stiffness = 0.0, damping = 0.0;
    };
    // A spring on the bend angle between two bones.
    struct Bend : BendPoints {
        int parent = -1;  // bone; -1: against the direction of the kinematic pose, where the child starts at a held point
        int child = -1;   // bone
        int hinge = -1;   // common joint point
        bool active = false;
        SpringDamper spring;      // N m, N m s
    };
    struct MassMoments {  // of the free joint points of a part of a tree, about the root at rest
        double mass = 0.0, second = 0.0;  // kg, kg m^2
        Vec3 first = Vec3::Zero();        // kg m
        int held = 0;                     // number of held points in the part
    };
    // Of the part that is reached from joint point `from` through its neighbour `to`.
    [[nodiscard]] MassMoments beyond(int from, int to) const;
    struct Limit {
        double energy = 0.0, force = 0.0, stiffness = 0.0, damping = 0.0;  // J, N, N/m, N s/m
    };
    [[nodiscard]] Limit limit(std::size_t bone, const BoneTargets& targets) const;
    [[nodiscard]] Vec3 carried(const Bend& bend, const BoneTargets& targets) const;
    [[nodiscard]] Vec3 carriedUnbent(const Bend& bend, const BoneTargets& targets) const;
    // What a step does with forces and derivatives: see forces().
    struct Step {
        const std::vector<Vec3>& v;
        std::vector<Vec3>& force;
        BlockCholesky<3>* system;
        double seconds;
        const std::vector<Freedom>& freedom;
        const Vec3& normal;
    };
    // Spring and damper of a bend whose child points `least` radians or more away from t, where what t does by itself turns by `drift` (rad/s).
    void addBend(const Bend& bend, const Vec3& t, double least, const Vec3& drift, const Step& step);
    void add(BlockCholesky<3>& system, int i, int j, const Eigen::Matrix3d& block, const std::vector<Freedom>& freedom, const Vec3& normal) const;

    Skeleton skeleton_;
    BoneTree tree_;
    std::vector<double> mass_;
    double rollArm_ = 0.0;             // m: inertia of roll = mass x arm^2
    std::vector<Bend> bends_;
    std::vector<Bend> stops_;          // beyond the bend limits of bones
    std::vector<SpringDamper> stretch_, limit_, roll_, twistStop_;  // per bone
    std::vector<SpringDamper> return_;         // per joint point
    std::vector<std::pair<int, int>> pairs_;

    // The joint points as rooted trees.
    std::vector<int> order_;           // parents first
    std::vector<int> above_, aboveBone_;  // -1: a root
    std::vector<int> root_;            // of each joint point
    std::vector<MassMoments> below_;   // per joint point: of it and all below it

    // Of one evaluation, per bone.
    struct Arm {
        Vec3 direction;
        double length = 0.0;
        // Jacobians by the end's move minus the start's: of the bone's rotation vector, of that of what it carries, and the latter bounded.
        Eigen::Matrix3d rotation, carries, carriesAbout;
    };
    void arms(const std::vector<Vec3>& x, const BoneTargets& targets) const;
    mutable std::vector<Arm> arms_;
    std::vector<double> rollDiagonal_, rollBelow_;
};

}  // namespace imomushi
