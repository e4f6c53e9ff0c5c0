// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/kept_pose.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

/// A kept pose as numbers from rest, which can be weighted and added. What needs no number is left out.
struct PoseParts {
    struct Bone {
        int bone = -1;            ///< of the skeleton
        Vec3 turn = Vec3::Zero(); ///< about its parent with its roll, a rotation vector
        double longer = 0.0;      ///< by this part of its length at rest
    };
    struct Root {
        int bone = -1;            ///< of the skeleton, without a parent
        Vec3 by = Vec3::Zero();   ///< m, of its start
    };
    struct Handle {
        int handle = -1;          ///< of the plan
        Vec3 by = Vec3::Zero();   ///< m
        Vec3 turn = Vec3::Zero(); ///< a rotation vector
    };
    struct Morph {
        MorphRef morph;
        double more = 0.0;        ///< weight above that at rest
    };
    std::vector<Bone> bones;      ///< parents before children
    std::vector<Root> roots;
    std::vector<Handle> handles;  ///< held in the world
    std::vector<Morph> morphs;
};

/// Parts of what is seen that are turned by hand are not among them.
PoseParts partsOf(const KeptPose& pose, const Document& document, const CharacterPlan& plan, const BoneTree& tree);

/// The whole rotation of a bone, with its roll. `roll`: of its end.
Eigen::Quaterniond wholeRotation(const BoneTree& tree, std::size_t bone, const Eigen::Quaterniond& frame, double roll);

/// How much of each pose is in `now`: weights, 0 ... 1, of the weighted sum of `poses` that is nearest to `now` in the sense of least squares. `known`: what of each is in there anyway. One that is
/// not `asked` for has no more than that: 0.
std::vector<double> weightsIn(const PoseParts& now, std::span<const PoseParts> poses, const CharacterPlan& plan, std::span<const double> known, const std::vector<bool>& asked);

}  // namespace imomushi
