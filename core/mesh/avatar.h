// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>

namespace imomushi {

/// The humanoid bones of VRM 1.0, parents before children. `above`: the role whose bone the parent is, or stands in for where it has none; "": none.
struct HumanRole {
    std::string_view name, above;
    bool required = false;
};
inline constexpr std::array<HumanRole, 55> kHumanRoles = {{
    {"hips", "", true}, {"spine", "hips", true}, {"chest", "spine"}, {"upperChest", "chest"}, {"neck", "upperChest"}, {"head", "neck", true}, {"leftEye", "head"}, {"rightEye", "head"}, {"jaw", "head"},
    {"leftUpperLeg", "hips", true}, {"leftLowerLeg", "leftUpperLeg", true}, {"leftFoot", "leftLowerLeg", true}, {"leftToes", "leftFoot"},
    {"rightUpperLeg", "hips", true}, {"rightLowerLeg", "rightUpperLeg", true}, {"rightFoot", "rightLowerLeg", true}, {"rightToes", "rightFoot"},
    {"leftShoulder", "upperChest"}, {"leftUpperArm", "leftShoulder", true}, {"leftLowerArm", "leftUpperArm", true}, {"leftHand", "leftLowerArm", true},
    {"rightShoulder", "upperChest"}, {"rightUpperArm", "rightShoulder", true}, {"rightLowerArm", "rightUpperArm", true}, {"rightHand", "rightLowerArm", true},
    {"leftThumbMetacarpal", "leftHand"}, {"leftThumbProximal", "leftThumbMetacarpal"}, {"leftThumbDistal", "leftThumbProximal"},
    {"leftIndexProximal", "leftHand"}, {"leftIndexIntermediate", "leftIndexProximal"}, {"leftIndexDistal", "leftIndexIntermediate"},
    {"leftMiddleProximal", "leftHand"}, {"leftMiddleIntermediate", "leftMiddleProximal"}, {"leftMiddleDistal", "leftMiddleIntermediate"},
    {"leftRingProximal", "leftHand"}, {"leftRingIntermediate", "leftRingProximal"}, {"leftRingDistal", "leftRingIntermediate"},
    {"leftLittleProximal", "leftHand"}, {"leftLittleIntermediate", "leftLittleProximal"}, {"leftLittleDistal", "leftLittleIntermediate"},
    {"rightThumbMetacarpal", "rightHand"}, {"rightThumbProximal", "rightThumbMetacarpal"}, {"rightThumbDistal", "rightThumbProximal"},
    {"rightIndexProximal", "rightHand"}, {"rightIndexIntermediate", "rightIndexProximal"}, {"rightIndexDistal", "rightIndexIntermediate"},
    {"rightMiddleProximal", "rightHand"}, {"rightMiddleIntermediate", "rightMiddleProximal"}, {"rightMiddleDistal", "rightMiddleIntermediate"},
    {"rightRingProximal", "rightHand"}, {"rightRingIntermediate", "rightRingProximal"}, {"rightRingDistal", "rightRingIntermediate"},
    {"rightLittleProximal", "rightHand"}, {"rightLittleIntermediate", "rightLittleProximal"}, {"rightLittleDistal", "rightLittleIntermediate"},
}};

/// Null: there is no such role.
constexpr const HumanRole* humanRole(std::string_view name) {
    for (const HumanRole& role : kHumanRoles)
        if (role.name == name) return &role;
    return nullptr;
}

}  // namespace imomushi
