// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

struct CharacterPlan;

inline constexpr std::size_t kMostKeptPoses = 1000;  ///< of a document

/// A pose that the artist kept by name: bones as they were shown, and what held them. What is not in the document any more, or came later, takes no part in it.
struct KeptPose {
    std::string name;
    struct Bone {
        Vec3 start = Vec3::Zero(), end = Vec3::Zero();  ///< m, world
        Eigen::Quaterniond frame = Eigen::Quaterniond::Identity();  ///< see Pose::frames
        double startRoll = 0.0, endRoll = 0.0;  ///< radians
    };
    std::map<PartId, Bone> bones;
    std::map<EndpointRef, EndpointGoal> goals;  ///< no glides
    std::map<FaceRef, HandleGoal> handles;      ///< no glides; the others are at rest
    std::map<PartRef, Eigen::Quaterniond> turns;
    std::map<MorphRef, double> morphs;          ///< the others are at rest
};

/// The pose of the document: as it is shown without motion. `name` is empty.
KeptPose poseOf(const Document& document, const CharacterPlan& plan);

/// Brings the document to a pose, by `share` (0...1) of the way from where it is; 1: exactly, and what holds it is what held it. Less: targets go their part of the way,
/// and those that only one of both has are kept until it is reached. Bones and their targets alone go straight; inverse kinematics mend what that shortens.
void applyPose(Document& document, const CharacterPlan& plan, const KeptPose& pose, double share);

/// Left and right exchanged, by names (otherSide()); what is in the middle is mirrored in itself. Measured from rest, so that sides which are not quite alike keep their
/// shape. `unpaired`: names of bones and handles that have a side, and nothing on the other one: they stay as in `pose`.
KeptPose mirrored(const KeptPose& pose, const Document& document, const CharacterPlan& plan, std::vector<std::string>& unpaired);

/// These bones as at rest against their parents; what hangs on them goes along, and targets there are let go, which pins are not.
void restBones(Document& document, const CharacterPlan& plan, const std::set<PartId>& bones);
/// And all that hang on them.
std::set<PartId> withChains(const CharacterPlan& plan, std::set<PartId> bones);

/// Null: there is none of that name.
const KeptPose* keptPose(const Document& document, std::string_view name);
const KeptPoses& keptPoses(const Document& document);
void setKeptPoses(Document& document, KeptPoses poses);

/// As a project keeps them. Errors of keptPosesFrom(): "bad-pose".
Json keptPosesJson(const KeptPoses& poses);
Result<KeptPoses> keptPosesFrom(const Json& list);

}  // namespace imomushi
