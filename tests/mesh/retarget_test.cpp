// SPDX-License-Identifier: GPL-3.0-or-later
// Clips of one skeleton on another one.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>

#include "core/mesh/humanoid.h"
#include "core/mesh/retarget.h"

using namespace imomushi;

namespace {

using Turn = Eigen::Quaterniond;

struct Limb {
    const char *name, *parent;
    Vec3 head;
};

/// A rig with its bones' own axes turned at random, so that nothing is right by chance. `roll`: which random axes.
Rig rigOfLimbs(const std::vector<Limb>& limbs, unsigned roll, const Eigen::Matrix4d& toScene = Eigen::Matrix4d::Identity()) {
    Rig rig;
    rig.toScene = toScene;
    std::srand(roll);
    const Eigen::Matrix4d back = toScene.inverse();
    for (const Limb& limb : limbs) {
        RigBone bone;
        bone.name = limb.name;
        bone.parent = rig.boneIndex(limb.parent);
        bone.node = static_cast<std::int32_t>(rig.nodes.size());
        bone.head = limb.head;
        bone.rotation = roll == 0 ? Turn::Identity() : Turn(Eigen::Vector4d::Random()).normalized();
        RigNode node;
        node.parent = bone.parent;  // a node per bone
        const Turn parentTurn = bone.parent < 0 ? nearestRotation(toScene.topLeftCorner<3, 3>()) : rig.bones[static_cast<std::size_t>(bone.parent)].rotation;
        node.rotation = (parentTurn.conjugate() * bone.rotation).normalized();
        const Vec3 above = bone.parent < 0 ? Vec3::Zero() : rig.bones[static_cast<std::size_t>(bone.parent)].head;
        const double size = toScene.topLeftCorner<3, 3>().col(0).norm();
        node.translation = bone.parent < 0 ? Vec3(back.topLeftCorner<3, 3>() * bone.head + back.topRightCorner<3, 1>()) : Vec3(parentTurn.conjugate() * (bone.head - above) / size);
        rig.nodes.push_back(node);
        rig.bones.push_back(bone);
    }
    guessTails(rig);
    REQUIRE(checkRig(rig, 0).empty());
    const auto rest = posedRig(rig, {"rest", 0.0, {}}, 0.0);
    for (std::size_t b = 0; b < rig.bones.size(); ++b) REQUIRE((rest[b].head - rig.bones[b].head).norm() < 1e-9);
    return rig;
}

/// A human as Mixamo calls it, arms hanging by `arms` radians from the level.
std::vector<Limb> mixamo(double size, double arms) {
    const Vec3 along(std::cos(arms), -std::sin(arms), 0.0), other(-along.x(), along.y(), 0.0);
    const Vec3 left(0.18 * size, 1.4 * size, 0.0), right(-0.18 * size, 1.4 * size, 0.0);
    return {{"mixamorig:Hips", "", {0, 0.95 * size, 0}}, {"mixamorig:Spine", "mixamorig:Hips", {0, 1.05 * size, 0}}, {"mixamorig:Spine1", "mixamorig:Spine", {0, 1.15 * size, 0}}, {"mixamorig:Spine2", "mixamorig:Spine1", {0, 1.25 * size, 0}},
            {"mixamorig:Neck", "mixamorig:Spine2", {0, 1.5 * size, 0}}, {"mixamorig:Head", "mixamorig:Neck", {0, 1.58 * size, 0}},
            {"mixamorig:LeftArm", "mixamorig:Spine2", left}, {"mixamorig:LeftForeArm", "mixamorig:LeftArm", left + 0.28 * size * along}, {"mixamorig:LeftHand", "mixamorig:LeftForeArm", left + 0.53 * size * along},
            {"mixamorig:RightArm", "mixamorig:Spine2", right}, {"mixamorig:RightForeArm", "mixamorig:RightArm", right + 0.28 * size * other}, {"mixamorig:RightHand", "mixamorig:RightForeArm", right + 0.53 * size * other},
            {"mixamorig:LeftUpLeg", "mixamorig:Hips", {0.1 * size, 0.9 * size, 0}}, {"mixamorig:LeftLeg", "mixamorig:LeftUpLeg", {0.1 * size, 0.5 * size, 0.01 * size}}, {"mixamorig:LeftFoot", "mixamorig:LeftLeg", {0.1 * size, 0.09 * size, 0}}, {"mixamorig:LeftToeBase", "mixamorig:LeftFoot", {0.1 * size, 0.02 * size, 0.12 * size}},
            {"mixamorig:RightUpLeg", "mixamorig:Hips", {-0.1 * size, 0.9 * size, 0}}, {"mixamorig:RightLeg", "mixamorig:RightUpLeg", {-0.1 * size, 0.5 * size, 0.01 * size}}, {"mixamorig:RightFoot", "mixamorig:RightLeg", {-0.1 * size, 0.09 * size, 0}}, {"mixamorig:RightToeBase", "mixamorig:RightFoot", {-0.1 * size, 0.02 * size, 0.12 * size}}};
}

/// Another human: short thighs, long shins, no third spine, other names.
std::vector<Limb> child() {
    return {{"hips", "", {0, 0.5, 0}}, {"spine", "hips", {0, 0.56, 0}}, {"chest", "spine", {0, 0.64, 0}}, {"neck", "chest", {0, 0.8, 0}}, {"head", "neck", {0, 0.84, 0}},
            {"upperArm.L", "chest", {0.1, 0.76, 0}}, {"lowerArm.L", "upperArm.L", {0.22, 0.76, 0}}, {"hand.L", "lowerArm.L", {0.34, 0.76, 0}},
            {"upperArm.R", "chest", {-0.1, 0.76, 0}}, {"lowerArm.R", "upperArm.R", {-0.22, 0.76, 0}}, {"hand.R", "lowerArm.R", {-0.34, 0.76, 0}},
            {"thigh.L", "hips", {0.07, 0.47, 0}}, {"shin.L", "thigh.L", {0.07, 0.3, 0.01}}, {"foot.L", "shin.L", {0.07, 0.05, 0}}, {"toe.L", "foot.L", {0.07, 0.01, 0.07}},
            {"thigh.R", "hips", {-0.07, 0.47, 0}}, {"shin.R", "thigh.R", {-0.07, 0.3, 0.01}}, {"foot.R", "shin.R", {-0.07, 0.05, 0}}, {"toe.R", "foot.R", {-0.07, 0.01, 0.07}}};
}

/// Turns a bone in the world about its own head: `keys` of an angle about an axis of the world at rest.
void turnBone(const Rig& rig, RigClip& clip, const char* name, const Vec3& axis, const std::vector<double>& angles) {
    const int b = rig.boneIndex(name);
    REQUIRE(b >= 0);
    const RigBone& bone = rig.bones[static_cast<std::size_t>(b)];
    RigTrack track;
    track.node = bone.node;
    track.path = RigTrack::Path::Rotation;
    for (std::size_t k = 0; k < angles.size(); ++k) {
        track.times.push_back(clip.seconds * static_cast<double>(k) / static_cast<double>(angles.size() - 1));
        const Turn q = (rig.nodes[static_cast<std::size_t>(bone.node)].rotation * bone.rotation.conjugate() * Turn(Eigen::AngleAxisd(angles[k], axis)) * bone.rotation).normalized();
        track.values.insert(track.values.end(), q.coeffs().data(), q.coeffs().data() + 4);
    }
    clip.tracks.push_back(std::move(track));
}

RigClip dance(const Rig& rig, const std::function<std::string(const char*)>& name) {
    RigClip clip{"dance", 1.2, {}};
    turnBone(rig, clip, name("Hips").c_str(), Vec3::UnitY(), {0.0, 0.3, -0.2, 0.0});
    turnBone(rig, clip, name("Spine1").c_str(), Vec3::UnitX(), {0.0, 0.2, 0.1, 0.0});
    turnBone(rig, clip, name("LeftArm").c_str(), Vec3(0.2, 0.3, 1.0).normalized(), {0.0, 0.5, -0.4, 0.1});
    turnBone(rig, clip, name("RightForeArm").c_str(), Vec3::UnitY(), {0.0, 0.9, 0.2, 0.0});
    turnBone(rig, clip, name("LeftHand").c_str(), Vec3::UnitX(), {0.0, 0.4, 0.2, -0.3});
    turnBone(rig, clip, name("Head").c_str(), Vec3::UnitZ(), {0.0, 0.2, -0.3, 0.0});
    return clip;
}
std::string mixamoName(const char* name) { return std::string("mixamorig:") + name; }

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

TEST_CASE("humanoid bones are told from names of Mixamo, Biped, VRoid, Rigify and Blender") {
    const auto role = [](std::initializer_list<const char*> names, const char* of) {
        Rig rig;
        for (const char* name : names) rig.bones.emplace_back().name = name;
        for (const RigRole& r : humanRoles(rig))
            if (rig.bones[static_cast<std::size_t>(r.bone)].name == of) return r.role;
        return std::string();
    };
    const auto alone = [&](const char* name) { return role({name}, name); };
    CHECK(alone("mixamorig:LeftUpLeg") == "leftUpperLeg");
    CHECK(alone("mixamorig:LeftLeg") == "leftLowerLeg");
    CHECK(alone("mixamorig1:RightHandThumb1") == "rightThumbMetacarpal");
    CHECK(alone("Bip01 L UpperArm") == "leftUpperArm");
    CHECK(alone("Bip001 R Calf") == "rightLowerLeg");
    CHECK(alone("J_Bip_L_LowerArm") == "leftLowerArm");
    CHECK(alone("J_Bip_C_Hips") == "hips");
    CHECK(alone("DEF-forearm.R") == "rightLowerArm");
    CHECK(alone("upper_arm.L") == "leftUpperArm");
    CHECK(alone("thigh_r") == "rightUpperLeg");
    CHECK(alone("LeftToeBase") == "leftToes");
    CHECK(alone("leftIndexProximal") == "leftIndexProximal");
    CHECK(alone("f_index.02.L") == "");
    CHECK(alone("tail") == "");
    CHECK(alone("hair.L") == "");
    CHECK(role({"Spine", "Spine1", "Spine2"}, "Spine2") == "upperChest");
    CHECK(role({"spine", "spine.001", "chest"}, "spine") == "spine");
    CHECK(role({"l_leg", "l_calf"}, "l_leg") == "leftUpperLeg");
}

TEST_CASE("a clip on its own skeleton is what it was") {
    const Rig rig = rigOfLimbs(mixamo(1.0, 0.7), 3);
    const RigClip clip = dance(rig, mixamoName);
    const RetargetedClip made = retarget(rig, clip, rig);
    CHECK(made.followed.size() == rig.bones.size());
    CHECK(made.byNames == static_cast<int>(rig.bones.size()));
    CHECK(made.lost.empty());
    CHECK(made.clip.seconds == doctest::Approx(clip.seconds));
    for (const double t : {0.0, 0.25, 0.4, 0.8, 1.2}) {
        const auto a = posedRig(rig, clip, t), b = posedRig(rig, made.clip, t);
        for (std::size_t k = 0; k < a.size(); ++k) {
            CHECK((a[k].head - b[k].head).norm() < 1e-9);
            CHECK(a[k].rotation.angularDistance(b[k].rotation) < 1e-6);
        }
    }
}

TEST_CASE("arms that hang at rest suit a figure whose arms are spread: limbs point where those of the clip do, whatever the axes, names and units") {
    const Rig source = rigOfLimbs(mixamo(1.0, 0.8), 5);
    const RigClip clip = dance(source, mixamoName);
    Eigen::Matrix4d cm = Eigen::Matrix4d::Identity();  // a file in centimetres that lies on its back
    cm.topLeftCorner<3, 3>() = 0.01 * Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix();
    for (const Rig& figure : {rigOfLimbs(mixamo(0.6, 0.0), 7), rigOfLimbs(child(), 9), rigOfLimbs(child(), 11, cm)}) {
        const RetargetedClip made = retarget(source, clip, figure);
        CHECK(checkClip(made.clip, figure.nodes.size()).empty());
        CHECK(made.followed.size() >= 19);
        const auto sourceRoles = humanRoles(source), figureRoles = humanRoles(figure);
        const auto at = [](const std::vector<RigRole>& roles, const char* role) {
            for (const RigRole& r : roles)
                if (r.role == role) return static_cast<std::size_t>(r.bone);
            FAIL("no " << role);
            return std::size_t{0};
        };
        for (const double t : {0.0, 0.2, 0.5, 0.9, 1.2}) {
            const auto a = posedRig(source, clip, t), b = posedRig(figure, made.clip, t);
            for (const auto& [from, to] : {std::pair{"leftUpperArm", "leftLowerArm"}, {"leftLowerArm", "leftHand"}, {"rightUpperArm", "rightLowerArm"}, {"rightLowerArm", "rightHand"}}) {
                const Vec3 x = a[at(sourceRoles, to)].head - a[at(sourceRoles, from)].head, y = b[at(figureRoles, to)].head - b[at(figureRoles, from)].head;
                CHECK(std::acos(std::min(1.0, x.normalized().dot(y.normalized()))) < 0.1 * kDegree);
            }
            // Trunk and head turn from their own rest as those of the clip do.
            for (const char* role : {"hips", "spine", "head"}) {
                const std::size_t s = at(sourceRoles, role), f = at(figureRoles, role);
                const Turn x = a[s].rotation * source.bones[s].rotation.conjugate(), y = b[f].rotation * figure.bones[f].rotation.conjugate();
                CHECK(x.angularDistance(y) < 0.1 * kDegree);
            }
        }
        // Bones keep their lengths.
        const auto pose = posedRig(figure, made.clip, 0.5);
        for (std::size_t k = 1; k < pose.size(); ++k) {
            const auto parent = static_cast<std::size_t>(figure.bones[k].parent);
            CHECK((pose[k].head - pose[parent].head).norm() == doctest::Approx((figure.bones[k].head - figure.bones[parent].head).norm()).epsilon(1e-6));
        }
    }
}

TEST_CASE("planted feet stay where they were, on legs of other proportions") {
    const Rig source = rigOfLimbs(mixamo(1.0, 0.8), 13), figure = rigOfLimbs(child(), 15);
    // A squat: the hips go down and forward, thighs and shins turn so that the ankles stay.
    RigClip clip{"squat", 1.0, {}};
    const RigBone& hips = source.bones[0];
    std::vector<double> thigh, shin, foot;
    RigTrack down{hips.node, RigTrack::Path::Translation, RigTrack::Interpolation::Linear, {}, {}};
    const Vec3 hip = source.bones[static_cast<std::size_t>(source.boneIndex("mixamorig:LeftUpLeg"))].head, knee = source.bones[static_cast<std::size_t>(source.boneIndex("mixamorig:LeftLeg"))].head,
               ankle = source.bones[static_cast<std::size_t>(source.boneIndex("mixamorig:LeftFoot"))].head;
    const int keys = 61;
    for (int k = 0; k < keys; ++k) {
        const double t = k / (keys - 1.0), drop = 0.2 * std::sin(std::numbers::pi * t);
        const Vec3 at = hip - Vec3(0, drop, 0);
        const double a = (knee - hip).norm(), b = (ankle - knee).norm(), far = (ankle - at).norm();
        // Angles against straight down, within the plane of the leg; the knee goes forward.
        const double forward = std::acos((a * a + far * far - b * b) / (2 * a * far)), tilt = std::atan2((ankle - at).z(), -(ankle - at).y());
        const Vec3 newKnee = at + a * Vec3(0, -std::cos(tilt + forward), std::sin(tilt + forward));
        const auto angleOf = [](const Vec3& d) { return std::atan2(d.z(), -d.y()); };
        thigh.push_back(-(angleOf(newKnee - at) - angleOf(knee - hip)));
        shin.push_back(-(angleOf(ankle - newKnee) - angleOf(ankle - knee)) - thigh.back());
        foot.push_back(-thigh.back() - shin.back());
        down.times.push_back(t);
        const Vec3 to = hips.head - Vec3(0, drop, 0);
        down.values.insert(down.values.end(), to.data(), to.data() + 3);
    }
    for (const char* side : {"Left", "Right"}) {
        turnBone(source, clip, mixamoName((std::string(side) + "UpLeg").c_str()).c_str(), Vec3::UnitX(), thigh);
        turnBone(source, clip, mixamoName((std::string(side) + "Leg").c_str()).c_str(), Vec3::UnitX(), shin);
        turnBone(source, clip, mixamoName((std::string(side) + "Foot").c_str()).c_str(), Vec3::UnitX(), foot);
    }
    clip.tracks.push_back(down);
    for (int k = 0; k <= 20; ++k) REQUIRE((posedRig(source, clip, k / 20.0)[static_cast<std::size_t>(source.boneIndex("mixamorig:LeftFoot"))].head - ankle).norm() < 2e-3);
    const RetargetedClip made = retarget(source, clip, figure);
    CHECK(made.feet);
    const auto own = static_cast<std::size_t>(figure.boneIndex("foot.L")), shinOf = static_cast<std::size_t>(figure.boneIndex("shin.L"));
    double slide = 0.0, lowest = 1.0, knees = 0.0;
    for (int k = 0; k <= 60; ++k) {
        const auto pose = posedRig(figure, made.clip, k / 60.0);
        slide = std::max(slide, (pose[own].head - figure.bones[own].head).norm());
        lowest = std::min(lowest, pose[0].head.y());
        knees = std::max(knees, pose[shinOf].head.z());
    }
    CHECK(slide < 0.01 * 0.95);  // of the figure's height
    CHECK(lowest < 0.42);        // the hips went down by as much of the legs
    CHECK(knees > 0.05);         // knees bend forward
}

TEST_CASE("a figure that looks another way is turned to, and what has no counterpart is told") {
    const Rig source = rigOfLimbs(mixamo(1.0, 0.8), 17);
    RigClip clip = dance(source, mixamoName);
    std::vector<Limb> back = child();
    for (Limb& limb : back) limb.head = Vec3(-limb.head.x(), limb.head.y(), -limb.head.z());
    std::erase_if(back, [](const Limb& limb) { return std::string(limb.name) == "hand.L"; });
    const Rig figure = rigOfLimbs(back, 19);
    const RetargetedClip made = retarget(source, clip, figure);
    CHECK(made.lost == std::vector<std::string>{"mixamorig:LeftHand"});
    const auto a = posedRig(source, clip, 0.4), b = posedRig(figure, made.clip, 0.4);
    const auto dir = [](const Rig& rig, const std::vector<RigPose>& pose, const char* from, const char* to) {
        return Vec3((pose[static_cast<std::size_t>(rig.boneIndex(to))].head - pose[static_cast<std::size_t>(rig.boneIndex(from))].head).normalized());
    };
    const Vec3 x = dir(source, a, "mixamorig:RightForeArm", "mixamorig:RightHand"), y = dir(figure, b, "lowerArm.R", "hand.R");
    CHECK((Vec3(-x.x(), x.y(), -x.z()) - y).norm() < 2e-3);
    // Nothing in common.
    const Rig worm = rigOfLimbs({{"w1", "", {0, 0, 0}}, {"w2", "w1", {0, 1, 0}}}, 0);
    CHECK(retarget(source, clip, worm).clip.tracks.empty());
}
