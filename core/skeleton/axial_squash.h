// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/skeleton/rod_energy.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// Straight chains that are pushed along their axis squash before they fold. A chain is the path of bones between two held points where nothing else that is
/// held hangs on it, straight at rest to kRestStraight and without a hinge (Skeleton::Bone), which folds. While its pose is straight, too, and its targets come together along its axis, the natural lengths of its
/// bones follow the distance of the targets: compression then carries no force, so that nothing buckles. This ends where the first bone of the chain is within
/// kReserve of its least length, or where a target leaves the axis; from there on natural lengths are those of rest and the chain folds (RodEnergy's side force
/// says to which side). A bent chain never squashes. Allocates in its constructor only.
class AxialSquash {
public:
    explicit AxialSquash(const Skeleton& skeleton);

    static constexpr double kReserve = 0.05;        ///< of the rest length
    static constexpr double kRestStraight = 0.99;   ///< distance of the ends over the length along the bones, at rest
    /// A target counts as on the axis within this part of the chain's length, plus a part of what the chain is to be shorter; at twice as much nothing squashes.
    static constexpr double kAside = 0.003, kAsidePerSquash = 0.1;

    /// Per bone its natural length relative to rest, 1 where nothing squashes. points: of the pose; continued: they are those that the last update led to, for
    /// an axis is that of the chain when it was last not squashed, or is squashed by more than kReserve.
    const std::vector<double>& update(const IkTargets& targets, const std::vector<Vec3>& points, bool continued);

private:
    struct Chain {
        int start = -1, end = -1;         // held joint points
        int first = 0, last = 0;          // its bones: bones_[first] ... bones_[last - 1]
        double length = 0.0;              // m, between its ends at rest
        double straightness = 1.0;        // length over that along the bones, at rest
        double least = 0.0;               // relative length at which it ends
        Vec3 axis = Vec3::UnitX();
        bool squashes = false;
    };
    void findChains(const std::vector<char>& held);
    void addChain(int start, int end);
    // Whether two bones that meet are a limb with a knee or an elbow.
    [[nodiscard]] bool isHinge(int a, int b) const;
    // Part of the squash, 0 ... 1, for a distance `apart` of the targets of a chain whose pose has the ends `along` apart.
    double partOf(Chain& chain, const Vec3& apart, const Vec3& along, const std::vector<Vec3>& points) const;

    const Skeleton skeleton_;
    std::vector<std::vector<int>> bonesAt_;  // per joint point
    std::vector<char> held_;                 // that the chains belong to
    std::vector<Chain> chains_;
    std::vector<int> bones_;
    std::vector<int> stack_, via_;           // of findChains(): points; per point the bone by which it was reached
    std::vector<double> natural_;
};

}  // namespace imomushi
