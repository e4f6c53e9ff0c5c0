// SPDX-License-Identifier: GPL-3.0-or-later
// What BoneDynamics refuses, and what to do about it.
#include <cmath>
#include <string>

#include "core/base/union_find.h"
#include "core/dynamics/bone_dynamics_state.h"

namespace imomushi {

namespace {

bool within(double value, double low, double high) { return std::isfinite(value) && value >= low && value <= high; }

}  // namespace

Result<void> checkSettings(const BoneDynamicsSettings& s, std::size_t bones) {
    if (s.springs.size() != 1 && s.springs.size() != bones)
        return fail("bad-value", "There are springs for " + std::to_string(s.springs.size()) + " of " + std::to_string(bones) +
                                     " bones: give one for all or one per bone.");
    for (const auto& b : s.springs) {
        for (const double hertz : {b.stretchHertz, b.bendHertz, b.rollHertz})
            if (!within(hertz, BoneSpring::kMinHertz, BoneSpring::kMaxHertz))
                return fail("bad-value", "The frequency of a bone is not between 0.01 and 1000 Hz: choose one that is.");
        for (const double ratio : {b.stretchDamping, b.bendDamping, b.rollDamping})
            if (!within(ratio, 0.0, BoneSpring::kMaxDamping))
                return fail("bad-value", "The damping ratio of a bone is not between 0 and 10: choose one that is.");
    }
    if (!within(s.returnHertz, 0.0, BoneSpring::kMaxHertz))
        return fail("bad-value", "The frequency of the return is not between 0 and 1000 Hz: choose one that is.");
    if (!within(s.airDamping, 0.0, BoneDynamicsSettings::kMaxAirDamping)) return fail("bad-value", "The air damping is not between 0 and 100 1/s: choose one that is.");
    constexpr double kMaxGravity = 1e12;  // m/s^2
    if (!allFinite(s.gravity) || s.gravity.cwiseAbs().maxCoeff() > kMaxGravity)
        return fail("bad-value", "Gravity is not below 1e12 m/s^2: choose a weaker one.");
    if (!s.ground) return {};
    if (!within(s.ground->friction, 0.0, 10.0)) return fail("bad-value", "The friction of the ground is not between 0 and 10: choose one that is.");
    return {};
}

Result<void> checkInput(const BoneDynamics::Input& input) {
    const int points = static_cast<int>(input.skeleton.points.size());
    if (input.mass.size() != input.skeleton.points.size())
        return fail("bad-value", "There are masses for " + std::to_string(input.mass.size()) + " of " + std::to_string(points) +
                                     " joint points: give one per joint point.");
    for (const double m : input.mass)
        if (!within(m, 1e-60, 1e60)) return fail("bad-value", "A joint point has no mass: give every one a mass above zero.");
    for (const auto& p : input.skeleton.points)
        if (!allFinite(p) || p.cwiseAbs().maxCoeff() > 1e30) return fail("bad-value", "A joint point has no place: give every one finite coordinates.");
    UnionFind trees(input.skeleton.points.size());
    for (const auto& b : input.skeleton.bones) {
        if (b.start < 0 || b.end < 0 || b.start >= points || b.end >= points)
            return fail("bad-place", "A bone ends at a joint point that is not there: connect it to one that is.");
        if (!within(b.length, 1e-30, 1e30) || (input.skeleton.points[b.start] - input.skeleton.points[b.end]).norm() == 0.0)
            return fail("bad-value", "A bone has no length: move its ends apart.");
        if (trees.find(b.start) == trees.find(b.end)) return fail("bone-loop", "The bones close a loop: bones form trees, so leave one bone of the loop out.");
        trees.unite(b.start, b.end);
    }
    return checkSettings(input.settings, input.skeleton.bones.size());
}

}  // namespace imomushi
