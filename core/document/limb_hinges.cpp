// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/limb_hinges.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "core/document/rig_follower.h"
#include "core/mesh/humanoid.h"

namespace imomushi {

namespace {

/// A limb that is bent by more at rest bends as it does there: above what knees and elbows of rest poses have by accident.
constexpr double kBent = 10.0 * std::numbers::pi / 180.0;
/// Skeleton::Bone::swing of the upper arm: the arm moves before the trunk does.
constexpr double kArmSwing = 0.2;
/// Skeleton::Bone::foldSlack of a forearm, which bears nothing.
constexpr double kArmSlack = 0.002;
/// How much up a forearm goes, for one forward.
constexpr double kUp = 0.2;

struct Limb {
    std::string_view upper, lower;
    bool arm = false;
};
constexpr std::array<Limb, 4> kLimbs{{{"leftUpperLeg", "leftLowerLeg"}, {"rightUpperLeg", "rightLowerLeg"}, {"leftUpperArm", "leftLowerArm", true}, {"rightUpperArm", "rightLowerArm", true}}};

struct Facing {
    Vec3 left, up, forward;  // unit, at rest
};

/// Nothing: the file does not say where its sides and its head are.
std::optional<Facing> facingOf(const Rig& rig, const std::vector<RigRole>& roles) {
    const auto head = [&](std::string_view wanted) -> std::optional<Vec3> {
        for (const RigRole& role : roles)
            if (role.role == wanted) return rig.bones[static_cast<std::size_t>(role.bone)].head;
        return {};
    };
    const auto low = head("hips"), high = head("head");
    auto left = head("leftUpperLeg"), right = head("rightUpperLeg");
    if (!left || !right) left = head("leftUpperArm"), right = head("rightUpperArm");
    if (!low || !high || !left || !right) return {};
    Facing facing;
    facing.up = *high - *low;
    facing.left = *left - *right;
    if (!(facing.up.norm() > 0.0)) return {};
    facing.up.normalize();
    facing.left -= facing.left.dot(facing.up) * facing.up;
    if (!(facing.left.norm() > 0.0)) return {};
    facing.left.normalize();
    facing.forward = facing.left.cross(facing.up);
    return facing;
}

/// Unit, across `along`; zero: there is no such axis. The bone `above` leads to `along`, both unit.
Vec3 axisOf(const Vec3& above, const Vec3& along, const Facing& facing, bool arm) {
    Vec3 axis = above.cross(along);
    if (std::atan2(axis.norm(), above.dot(along)) < kBent) axis = arm ? Vec3(along.cross(facing.forward + kUp * facing.up)) : Vec3(facing.left - facing.left.dot(along) * along);
    return axis.norm() > 0.1 * std::sin(kBent) ? Vec3(axis.normalized()) : Vec3::Zero();
}

}  // namespace

void addLimbHinges(CharacterPlan& plan, const Document& document) {
    auto& bones = plan.input.skeleton.bones;
    for (const auto& [id, character] : document.characters) {
        if (!character->rig) continue;
        const Rig& rig = *character->rig;
        const std::vector<RigRole> roles = humanRoles(rig);
        const auto facing = facingOf(rig, roles);
        if (!facing) continue;
        const RigFollower follower(document, plan, *character);
        const auto is = [&](std::size_t bone, std::string_view wanted) {
            const int file = follower.follows()[bone];
            for (const RigRole& role : roles)
                if (role.role == wanted) return role.bone == file;
            return false;
        };
        for (std::size_t b = 0; b < bones.size(); ++b) {
            auto& lower = bones[b];
            if (lower.parent < 0) continue;
            auto& upper = bones[static_cast<std::size_t>(lower.parent)];
            if (upper.end != lower.start) continue;
            for (const Limb& limb : kLimbs) {
                if (!is(b, limb.lower) || !is(static_cast<std::size_t>(lower.parent), limb.upper)) continue;
                const auto along = [&](const Skeleton::Bone& bone) {
                    return Vec3((plan.input.skeleton.points[static_cast<std::size_t>(bone.end)] - plan.input.skeleton.points[static_cast<std::size_t>(bone.start)]).normalized());
                };
                lower.hinge = axisOf(along(upper), along(lower), *facing, limb.arm);
                if (!limb.arm) continue;
                upper.swing = kArmSwing;
                lower.foldSlack = kArmSlack;
            }
        }
    }
}

}  // namespace imomushi
