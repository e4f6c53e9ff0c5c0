// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// The bones of a character at rest, as forests over joint points. Indices into these vectors are what the per-frame code uses; names
/// stay in the document.
struct Skeleton {
    struct Bone {
        int start = -1;           ///< joint point
        int end = -1;             ///< joint point
        int parent = -1;          ///< bone, -1: a root
        double length = 0.0;      ///< m at rest, > 0
        double minStretch = 0.5;  ///< smallest and largest length relative to rest
        double maxStretch = 2.0;
    };
    std::vector<Vec3> points;  ///< joint points at rest, m
    std::vector<Bone> bones;   ///< parents before children
};

/// A joint point that the artist holds.
struct Hold {
    int point = -1;
    Vec3 target = Vec3::Zero();
    bool hasRoll = false;
    double roll = 0.0;  ///< radians about the bone's axis, relative to rest
    bool operator==(const Hold&) const = default;
};

/// A pose: everything that the joint points and bones need to be drawn, and the state from which the next pose follows.
struct Pose {
    std::vector<Vec3> points;                 ///< per joint point, m
    /// Per bone: rotation from rest, parallel-transported, roll left out. Signs are consistent within a tree of bones: the scalar product of
    /// two neighbours is the cosine of half the bend between them.
    std::vector<Eigen::Quaterniond> frames;
    std::vector<double> roll;                 ///< per joint point, radians
};

/// The pose of rest: points as in the skeleton, no rotation.
Pose restPose(const Skeleton& skeleton);

/// Inverse kinematics on any forest with any number of held points and stretchable bones: the pose near the last one of least
/// stretch and bend whose held points are at their targets, or as near as the stretch limits allow.
/// Motion is smooth: kMotionGain and kRelaxation bound it, also over many solve() with the same holds, so that a small drag never makes a body
/// snap into a distant pose of less bend. Without holds nothing moves. Allocates in its constructor only.
class InverseKinematics {
public:
    explicit InverseKinematics(const Skeleton& skeleton);
    InverseKinematics(InverseKinematics&&) noexcept;
    InverseKinematics& operator=(InverseKinematics&&) noexcept;
    ~InverseKinematics();

    /// After a target moved, no joint point moves farther than this times the largest move of a target ...
    static constexpr double kMotionGain = 3.0;
    /// ... plus this times the mean rest length of the bones, until a target moves again: what a bent or compressed body gives back at each small
    /// drag. Only held points that have not arrived and still come nearer are given as much again in every solve().
    static constexpr double kRelaxation = 0.03;

    struct Report {
        bool settled = true;        ///< the pose no longer changes when solved again
        double largestMiss = 0.0;   ///< m, largest distance of a held point from its target
        bool outOfReach = false;    ///< a held point rests away from its target: stretch or bend limits keep it there
        bool finite = true;         ///< false: the step was refused and the last good pose kept
    };
    /// One frame: moves `pose` towards the holds (of two at one joint point the later counts). Targets must be finite.
    /// A held point without a roll keeps the roll it has; between held points roll spreads evenly along the bones.
    /// A pose that does not fit the skeleton counts as the pose of rest.
    Report solve(const std::vector<Hold>& holds, Pose& pose);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
