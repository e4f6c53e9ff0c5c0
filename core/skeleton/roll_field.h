// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/base/block_cholesky.h"
#include "core/skeleton/bone_tree.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Roll per joint point, harmonic along the bones (Laplace's equation on the forest with weights 1 / length) between points that are held and points where
/// limbs branch: these keep the roll that they have, so that a twist stays in its limb. Where bones have twist limits, twists beyond them meet a cubic barrier, and
/// goals are followed by springs whose torque saturates. Allocates in its constructor only.
class RollField {
public:
    /// unit: m, mean rest length of the bones.
    RollField(const Skeleton& skeleton, const BoneTree& tree, double unit);
    /// Sets the rolls of `goals` and spreads them to the points that are not `held` (one entry per joint point). Roll of a goal counts about the bone that
    /// ends at the point, or else one that starts there.
    void spread(const std::vector<IkGoal>& goals, const std::vector<char>& held, Pose& pose);

private:
    // After the field without limits, from the rolls before in `last_`: that of least energy with them, by Newton's method.
    void keepLimits(Pose& pose);
    [[nodiscard]] double energyOf(const std::vector<double>& roll) const;

    Skeleton skeleton_;
    bool limited_ = false;          // some bone limits its twist
    std::vector<double> last_, trial_, wanted_;  // rolls; wanted_: of goals
    std::vector<char> followed_;    // has a goal with a roll
    std::vector<double> rollSign_;  // see BoneTree
    std::vector<char> branches_;    // three bones or more meet there
    std::vector<char> fixed_;       // held, or a branch
    double unit_ = 0.0;
    BlockCholesky<3> system_;       // the same scalar in all three components
    std::vector<Vec3> rolls_;
};

}  // namespace imomushi
