// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "core/base/block_cholesky.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Where held joint points should be; one entry per joint point.
struct IkTargets {
    std::vector<char> held;
    std::vector<Vec3> place;  ///< m, where held
    struct Direction {
        int bone = -1;
        Vec3 direction = Vec3::UnitX();  ///< unit, start -> end
        double stiffness = 0.0;          ///< m: torque over the unit of force, per discrete curvature
    };
    std::vector<Direction> directions;  ///< bones whose direction is held, and upright ones
};

/// The elastic energy of bones as discrete elastic rods (Bergou et al., Discrete elastic rods, SIGGRAPH 2008), with springs that pull held points to their
/// targets. Forces are in units of the force that stretches a bone to twice its length, lengths in metres.
///   stretch  (strain^2 / 2) L per bone of rest length L, strain from its natural length, and a cubic barrier beyond the bone's stretch limits
///   bend     k |kappa|^2 / 2 per pair of neighbours, |kappa| = 2 tan(angle / 2) the discrete curvature, which keeps bones from folding flat, and a cubic barrier
///            beyond the bend limit of the child
///            A hinge (Skeleton::Bone) resists more across its axis and backwards, and the curvature that costs nothing is not 0 but what lets both bones have their rest lengths between the ends
///            that they have: what pushes a straight limb together folds it. That curvature follows from the pose alone and is fixed at the point of linearisation.
///   direction  K |kappa|^2 / 2 between a bone whose direction is held, or that is upright (Skeleton::Bone), and that direction
///   target   a spring whose force saturates, so that targets out of reach do not tear the body
///   side     a linear load across compressed straight bones, fixed at the point of linearisation: it chooses a side to buckle to
/// Allocates in its constructor only.
class RodEnergy {
public:
    explicit RodEnergy(const Skeleton& skeleton);

    [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
    [[nodiscard]] const BoneTree& tree() const { return tree_; }
    [[nodiscard]] double unit() const { return unit_; }  ///< m, mean rest length of the bones
    [[nodiscard]] double size() const { return size_; }  ///< m, of the skeleton
    /// IkTargets::Direction::stiffness of directions that are held, m.
    [[nodiscard]] double heldStiffness() const;
    /// Pairs of joint points that the matrix of linearise() couples.
    [[nodiscard]] const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }

    /// From the start of a bone to its end.
    [[nodiscard]] Vec3 along(int bone, const std::vector<Vec3>& points) const;
    /// Unit; a bone without length keeps the direction of its frame.
    [[nodiscard]] Vec3 directionOf(int bone, const std::vector<Vec3>& points, const Eigen::Quaterniond& frame) const;
    /// Parallel transport: roots are carried over from `from` in time, the others from their parents along the tree.
    void transport(const std::vector<Vec3>& points, const std::vector<Eigen::Quaterniond>& from, std::vector<Eigen::Quaterniond>& to) const;

    /// Natural lengths of the bones relative to rest, from now on; 1 before.
    void setNatural(const std::vector<double>& natural) { natural_ = natural; }
    /// Linearises at joint points x and bone frames: `force` becomes minus the gradient, `system` the Gauss-Newton matrix plus viscosity / unit().
    void linearise(const std::vector<Vec3>& x, const std::vector<Eigen::Quaterniond>& frames, const IkTargets& targets, double viscosity,
                   BlockCholesky<3>& system, std::vector<Vec3>& force);
    /// The energy at `points`, with frames transported from the last linearise().
    [[nodiscard]] double energy(const std::vector<Vec3>& points, const IkTargets& targets) const;
    /// Whether a bone turned by more than the angle of this cosine from the last linearise() to `points`.
    [[nodiscard]] bool turnsBeyond(double cosine, const std::vector<Vec3>& points) const;

private:
    // Two bones of a limb: root, joint and tip are joint points.
    struct Hinge {
        bool is = false;
        int root = -1, joint = -1, tip = -1;
        double upper = 0.0, lower = 0.0, apart = 0.0;  // m at rest: of the bones, and between root and tip
        double angle = 0.0;                            // rad at rest, between the bones
        double slack = 0.0;                            // Skeleton::Bone::foldSlack
    };
    // Two neighbouring bones and the joint points they have between them.
    struct Bend : BendPoints {
        int parent = -1, child = -1;
        double stiffness = 0.0;
        double limit = 0.0;  // of the discrete curvature, 0 and not `limited`: none
        bool limited = false;
        Hinge hinge;
    };
    struct Tension {
        double force = 0.0, slope = 0.0, energy = 0.0;
    };
    // Tension of a bone of that length, its derivative by the length, and its energy. Twice differentiable.
    [[nodiscard]] Tension stretch(std::size_t bone, double length) const;
    // The same of the barrier beyond a bend limit, by the discrete curvature.
    [[nodiscard]] Tension stop(const Bend& bend, double curvature) const;
    // Adds it to the gradient and to `system`, at the discrete curvature r with its derivatives by the points of the bend.
    void addStop(const Bend& bend, const Vec3& r, const Eigen::Matrix3d* jacobian, BlockCholesky<3>& system);
    // The discrete curvature of a hinge that costs nothing where root and tip are so far apart, >= 0.
    [[nodiscard]] static double folded(const Hinge& hinge, double apart);
    // The energy of a bend over its stiffness at the discrete curvature r, of its hinge with the axis `axis` now and the curvature `fold` that costs nothing.
    [[nodiscard]] static double hingeEnergy(const Vec3& r, const Vec3& axis, double fold);
    // Adds a hinge to the gradient and to `system`: discrete curvature r with its derivatives; `parent` is the direction of the parent over its length.
    void addHinge(const Bend& bend, std::size_t index, const Vec3& r, const Vec3& parent, const Eigen::Matrix3d* jacobian, BlockCholesky<3>& system);
    // Force of a target spring per metre at that distance, and its energy. The force falls with the distance: its secant as the stiffness majorises the
    // energy, so that steps descend (iteratively reweighted least squares).
    struct Pull {
        double perMetre = 0.0, energy = 0.0;
    };
    [[nodiscard]] Pull pull(const Vec3& miss) const;

    const Skeleton skeleton_;
    const BoneTree tree_;
    double unit_ = 0.0, size_ = 0.0;
    std::vector<Bend> bends_;
    std::vector<double> natural_;  // per bone
    std::vector<Vec3> restSide_;  // per bone, unit, across it
    std::vector<std::pair<int, int>> pairs_;

    // Of the last linearise().
    std::vector<Vec3> x_, gradient_, side_, direction_, bent_;
    std::vector<Eigen::Quaterniond> frames_;
    std::vector<double> fold_;                // per bend: folded() of a hinge
    std::vector<Vec3> axis_;                  // per bend: of a hinge, unit
    std::vector<double> bend2_;  // per bone: largest squared discrete curvature at its ends
};

}  // namespace imomushi
