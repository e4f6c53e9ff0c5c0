// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/base/vec3.h"

namespace imomushi {

/// The bones of a character at rest: a forest over joint points. Per-frame code uses indices into these vectors; names stay in the document.
struct Skeleton {
    struct Bone {
        int start = -1;           ///< joint point
        int end = -1;             ///< joint point
        int parent = -1;          ///< bone, -1: a root
        double length = 0.0;      ///< m at rest, > 0
        double minStretch = 0.5;  ///< smallest and largest length relative to rest
        double maxStretch = 2.0;
        double maxBend = kFreeBend;    ///< rad, largest angle to where its parent carries it at rest; of no effect without a parent
        double maxTwist = kFreeTwist;  ///< rad, largest difference of roll between its ends
        double stiffness = 1.0;        ///< of its stretch and of the bend to its parent, relative to others, > 0
        double upright = 0.0;          ///< m: how stiffly it keeps its direction of rest, a torque over the unit of force (RodEnergy) per discrete curvature; 0: not at all
        double swing = 1.0;            ///< times what resists its bend to its parent, > 0
        /// Unit, at rest, across the bone: a knee or an elbow. It bends from its parent about this axis, right-handed, where their limb is pushed together, and hardly about others or back (RodEnergy);
        /// zero: about any axis alike.
        Vec3 hinge = Vec3::Zero();
        double foldSlack = 0.01;       ///< of a hinge, > 0: a limb that is pushed together by less than about this part of its length hardly folds
        static constexpr double kFreeBend = 3.14159265358979323846, kFreeTwist = 20.0 * kFreeBend;  ///< no limit
        [[nodiscard]] bool limitsBend() const { return maxBend < kFreeBend; }
        [[nodiscard]] bool limitsTwist() const { return maxTwist < kFreeTwist; }
    };
    std::vector<Vec3> points;  ///< joint points at rest, m
    std::vector<Bone> bones;   ///< parents before children
};

/// A target of inverse kinematics: a joint point that the artist holds.
struct IkGoal {
    int point = -1;
    Vec3 target = Vec3::Zero();
    bool hasRoll = false;
    double roll = 0.0;  ///< radians about the bone's axis, relative to rest
    bool pinned = false;  ///< a pin, where the character stands; otherwise a drag
    int heldBone = -1;  ///< a bone at the point that keeps a direction, too: that of rest turned by `rotation`; -1: none
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit
    bool operator==(const IkGoal& o) const {
        return point == o.point && target == o.target && hasRoll == o.hasRoll && roll == o.roll && pinned == o.pinned && heldBone == o.heldBone && rotation.coeffs() == o.rotation.coeffs();
    }
};

/// Positions of joint points and rotations of bones: what is drawn, and the state that the next pose starts from.
struct Pose {
    std::vector<Vec3> points;                 ///< per joint point, m
    /// Per bone: the twist-free rotation from rest (Bishop frame: parallel transport along the tree and in time), without roll. Signs are consistent within
    /// a tree of bones: the scalar product of two neighbours is the cosine of half the bend angle between them.
    std::vector<Eigen::Quaterniond> frames;
    std::vector<double> roll;                 ///< per joint point, radians
};

/// The pose of rest: points as in the skeleton, no rotation.
Pose restPose(const Skeleton& skeleton);

}  // namespace imomushi
