// SPDX-License-Identifier: GPL-3.0-or-later
// Clips of one skeleton on figures of other proportions, names and rest poses.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/mesh/humanoid.h"
#include "core/mesh/retarget.h"
#include "tests/io/raw_scene.h"

using namespace imomushi;
using namespace io_test;

namespace {

using Turn = Eigen::Quaterniond;

constexpr double kDegree = std::numbers::pi / 180.0;

Turn about(const Vec3& axis, double degrees) { return Turn(Eigen::AngleAxisd(degrees * kDegree, axis.normalized())); }

/// A motion in words of a body: what time x in [0, 1] makes of it.
struct Motion {
    std::string name;
    double seconds = 2.0;
    std::function<Vec3(double)> hips = [](double) { return Vec3(0, 0, 0); };          ///< how far, m
    std::function<Turn(double)> pelvis = [](double) { return Turn::Identity(); };     ///< in the world
    std::map<std::string, std::function<Turn(double)>> turns = {};                      ///< of a bone after its parent, about axes of the world at rest
    std::function<Vec3(double, bool left)> foot = [](double, bool) { return Vec3(0, 0, 0); };  ///< how far the ankle is from where it rests, m
};

double wave(double x, double times) { return std::sin(2.0 * std::numbers::pi * times * x); }
double hump(double x) { return std::sin(std::numbers::pi * x); }
/// 0, then up and down within from ... to, then 0.
double during(double x, double from, double to) { return x <= from || x >= to ? 0.0 : std::pow(std::sin(std::numbers::pi * (x - from) / (to - from)), 2); }
/// From 0 to 1 within from ... to.
double step(double x, double from, double to) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

std::vector<Motion> motions() {
    std::vector<Motion> all;
    const auto add = [&](const char* name) -> Motion& {
        all.emplace_back().name = name;
        return all.back();
    };
    Motion& waving = add("wave");
    waving.turns["rig:RightArm"] = [](double x) { return about(Vec3::UnitZ(), -100.0 * hump(x)); };
    waving.turns["rig:RightForeArm"] = [](double x) { return about(Vec3::UnitZ(), -30.0 * hump(x) + 25.0 * wave(x, 4)); };
    waving.turns["rig:Head"] = [](double x) { return about(Vec3::UnitZ(), 8.0 * wave(x, 1)); };
    Motion& bow = add("bow");
    bow.turns["rig:Spine"] = [](double x) { return about(Vec3::UnitX(), 40.0 * hump(x)); };
    bow.turns["rig:Spine2"] = [](double x) { return about(Vec3::UnitX(), 20.0 * hump(x)); };
    bow.turns["rig:Head"] = [](double x) { return about(Vec3::UnitX(), 15.0 * hump(x)); };
    bow.hips = [](double x) { return Vec3(0, -0.02 * hump(x), -0.08 * hump(x)); };
    Motion& squat = add("squat");
    squat.hips = [](double x) { return Vec3(0, -0.3 * hump(x), 0.05 * hump(x)); };
    squat.turns["rig:LeftArm"] = squat.turns["rig:RightArm"] = [](double x) { return about(Vec3::UnitX(), -70.0 * hump(x)); };
    Motion& turn = add("turn");
    turn.pelvis = [](double x) { return about(Vec3::UnitY(), 35.0 * wave(x, 1)); };
    turn.hips = [](double x) { return Vec3(0, -0.03 * std::abs(wave(x, 1)), 0); };
    turn.turns["rig:Spine1"] = [](double x) { return about(Vec3::UnitY(), 15.0 * wave(x, 1)); };
    Motion& jump = add("jump");
    jump.hips = [](double x) { return Vec3(0, -0.15 * during(x, 0.0, 0.4) + 0.3 * during(x, 0.35, 0.75) - 0.1 * during(x, 0.7, 1.0), 0); };
    jump.foot = [](double x, bool) { return Vec3(0, 0.3 * during(x, 0.35, 0.75), 0); };
    Motion& kick = add("kick");
    kick.foot = [](double x, bool left) { return left ? Vec3(0.05, 0.35, 0.55) * during(x, 0.2, 0.8) : Vec3(0, 0, 0); };
    kick.hips = [](double x) { return Vec3(-0.06 * during(x, 0.1, 0.9), -0.03 * during(x, 0.1, 0.9), 0); };
    kick.turns["rig:RightArm"] = [](double x) { return about(Vec3(0.3, 1, 0.2), 30.0 * hump(x)); };
    Motion& look = add("look round");
    look.turns["rig:Neck"] = [](double x) { return about(Vec3::UnitY(), 25.0 * wave(x, 1)); };
    look.turns["rig:Head"] = [](double x) { return about(Vec3(0.2, 1, 0), 40.0 * wave(x, 1)); };
    Motion& clap = add("clap");
    clap.turns["rig:LeftArm"] = [](double x) { return about(Vec3::UnitY(), -60.0 * hump(x)); };
    clap.turns["rig:RightArm"] = [](double x) { return about(Vec3::UnitY(), 60.0 * hump(x)); };
    clap.turns["rig:LeftForeArm"] = [](double x) { return about(Vec3::UnitY(), -35.0 + 15.0 * wave(x, 5)); };
    clap.turns["rig:RightForeArm"] = [](double x) { return about(Vec3::UnitY(), 35.0 - 15.0 * wave(x, 5)); };
    clap.turns["rig:LeftHand"] = [](double x) { return about(Vec3::UnitX(), 20.0 * wave(x, 5)); };
    Motion& sit = add("sit");
    sit.hips = [](double x) { return Vec3(0, -0.36 * step(x, 0.1, 0.6), -0.3 * step(x, 0.1, 0.6)); };
    sit.turns["rig:Spine"] = [](double x) { return about(Vec3::UnitX(), 30.0 * during(x, 0.1, 0.7)); };
    Motion& aside = add("step sideways");
    aside.foot = [](double x, bool left) {
        return left ? Vec3(0.3 * step(x, 0.1, 0.4), 0.1 * during(x, 0.1, 0.4), 0) : Vec3(0.3 * step(x, 0.6, 0.9), 0.1 * during(x, 0.6, 0.9), 0);
    };
    aside.hips = [](double x) { return Vec3(0.3 * step(x, 0.15, 0.85), -0.05 * hump(x), 0); };
    return all;
}

/// What takes one direction and what is across it to others.
Turn fromFrames(const Vec3& along, const Vec3& across, const Vec3& toAlong, const Vec3& toAcross) {
    const auto frame = [](const Vec3& a, const Vec3& b) {
        Eigen::Matrix3d m;
        m.col(0) = a.normalized();
        m.col(2) = m.col(0).cross(b).normalized();
        m.col(1) = m.col(2).cross(m.col(0));
        return m;
    };
    return Turn(Eigen::Matrix3d(frame(toAlong, toAcross) * frame(along, across).transpose())).normalized();
}

/// The motion on a skeleton each node of which is a bone, by legs that reach where the feet are.
RigClip clipOf(const Motion& motion, const Rig& rig) {
    RigClip clip{motion.name, motion.seconds, {}};
    std::vector<RigTrack> tracks(rig.bones.size());
    RigTrack place{rig.bones[0].node, RigTrack::Path::Translation, RigTrack::Interpolation::Linear, {}, {}};
    const auto at = [&](const std::string& name) { return static_cast<std::size_t>(rig.boneIndex(name)); };
    const int frames = static_cast<int>(60.0 * motion.seconds);
    for (int f = 0; f <= frames; ++f) {
        const double x = static_cast<double>(f) / frames;
        std::vector<Turn> turned(rig.bones.size(), Turn::Identity());  // of each bone from its rest, in the world
        turned[0] = motion.pelvis(x);
        const Vec3 hips = rig.bones[0].head + motion.hips(x);
        for (std::size_t b = 1; b < rig.bones.size(); ++b) {
            turned[b] = turned[static_cast<std::size_t>(rig.bones[b].parent)];
            if (const auto more = motion.turns.find(rig.bones[b].name); more != motion.turns.end()) turned[b] = turned[b] * more->second(x);
            for (const std::string side : {"Left", "Right"}) {
                const std::size_t upper = at("rig:" + side + "UpLeg"), lower = at("rig:" + side + "Leg"), foot = at("rig:" + side + "Foot");
                if (b != upper && b != lower && b != foot) continue;
                const Vec3 forward = turned[0] * Vec3::UnitZ(), &knee = rig.bones[lower].head, &ankle = rig.bones[foot].head;
                const Vec3 from = hips + turned[0] * (rig.bones[upper].head - rig.bones[0].head), to = ankle + motion.foot(x, side == "Left");
                const double thigh = (knee - rig.bones[upper].head).norm(), shin = (ankle - knee).norm(), far = std::min((to - from).norm(), 0.99999 * (thigh + shin));
                const Vec3 along = (to - from).normalized(), pole = (forward - forward.dot(along) * along).normalized();
                const double bent = std::acos(std::clamp((thigh * thigh + far * far - shin * shin) / (2.0 * thigh * far), -1.0, 1.0));
                const Vec3 newKnee = from + thigh * (std::cos(bent) * along + std::sin(bent) * pole);
                if (b == upper) turned[b] = fromFrames(knee - rig.bones[upper].head, Vec3::UnitZ(), newKnee - from, pole + 0.3 * along);
                if (b == lower) turned[b] = fromFrames(ankle - knee, Vec3::UnitZ(), from + far * along - newKnee, pole);
                if (b == foot) turned[b] = Turn::Identity();  // level
            }
        }
        place.times.push_back(x * motion.seconds);
        place.values.insert(place.values.end(), hips.data(), hips.data() + 3);
        for (std::size_t b = 0; b < rig.bones.size(); ++b) {
            const RigBone& bone = rig.bones[b];
            const Turn world = turned[b] * bone.rotation, above = bone.parent < 0 ? Turn::Identity() : Turn(turned[static_cast<std::size_t>(bone.parent)] * rig.bones[static_cast<std::size_t>(bone.parent)].rotation);
            const Turn local = (above.conjugate() * world).normalized();
            tracks[b].times.push_back(x * motion.seconds);
            tracks[b].values.insert(tracks[b].values.end(), local.coeffs().data(), local.coeffs().data() + 4);
        }
    }
    for (std::size_t b = 0; b < tracks.size(); ++b) {
        tracks[b].node = rig.bones[b].node;
        tracks[b].path = RigTrack::Path::Rotation;
        clip.tracks.push_back(std::move(tracks[b]));
    }
    clip.tracks.push_back(std::move(place));
    return clip;
}

int boneOf(const std::vector<RigRole>& roles, const std::string& role) {
    for (const RigRole& r : roles)
        if (r.role == role) return r.bone;
    return -1;
}

}  // namespace

TEST_CASE("ten clips and a walk on three figures: bones turn as those of the clip within a degree, and planted feet stay within 1 % of the height") {
    const auto source = characterAt(kCharacters / "walk.glb", true);
    REQUIRE(source);
    const Rig& from = *source->rig;
    REQUIRE(from.nodes.size() == from.bones.size());
    std::vector<std::pair<RigClip, const Motion*>> clips;
    const std::vector<Motion> all = motions();
    REQUIRE(all.size() == 10);
    for (const Motion& motion : all) clips.emplace_back(clipOf(motion, from), &motion);
    clips.emplace_back(from.clips.at(0), nullptr);
    const std::map<std::string, std::string> next = {{"UpperArm", "LowerArm"}, {"LowerArm", "Hand"}, {"UpperLeg", "LowerLeg"}, {"LowerLeg", "Foot"}};
    for (const char* name : {"mannequin.glb", "avatar.glb", "two_materials.glb"}) {
        const auto figure = characterAt(kCharacters / name);
        REQUIRE(figure);
        const Rig& to = *figure->rig;
        const Points& v = figure->renderModel.mesh.body.vertices;
        const double height = v.col(1).maxCoeff() - v.col(1).minCoeff();
        const auto sourceRoles = humanRoles(from), figureRoles = humanRoles(to);
        for (const auto& [clip, motion] : clips) {
            CAPTURE(std::string(name));
            CAPTURE(clip.name);
            REQUIRE(checkClip(clip, from.nodes.size()).empty());
            const RetargetedClip made = retarget(from, clip, to);
            REQUIRE(made.followed.size() >= 19);
            double worst = 0.0, slide = 0.0;
            std::string which;
            std::array<Vec3, 2> stood;
            std::array<Vec3, 2> goal{Vec3(1e9, 0, 0), Vec3(1e9, 0, 0)};
            const int frames = static_cast<int>(60.0 * clip.seconds);
            const auto ankleAt = [&](double t, const char* role) { return posedRig(from, clip, t)[static_cast<std::size_t>(boneOf(sourceRoles, role))].head; };
            for (int f = 0; f <= frames; ++f) {
                const double t = f / 60.0;
                const auto p = posedRig(from, clip, t), q = posedRig(to, made.clip, t);
                const auto turnedIn = [](const Rig& rig, const std::vector<RigPose>& pose, int b) { return Turn(pose[static_cast<std::size_t>(b)].rotation * rig.bones[static_cast<std::size_t>(b)].rotation.conjugate()); };
                const auto headIn = [](const std::vector<RigPose>& pose, int b) -> const Vec3& { return pose[static_cast<std::size_t>(b)].head; };
                for (const RigRole& role : figureRoles) {
                    const int s = boneOf(sourceRoles, role.role), b = role.bone;
                    if (s < 0) continue;
                    const std::string side = role.role.rfind("left", 0) == 0 ? "left" : role.role.rfind("right", 0) == 0 ? "right" : "", part = role.role.substr(side.size());
                    double off = 0.0;
                    if (const auto pointing = side.empty() ? next.end() : next.find(part); pointing != next.end()) {
                        // The rest poses differ: it points where the other does. A leg that carries bends as its own proportions need.
                        if (part.ends_with("Leg")) {
                            const std::string foot = side + "Foot";
                            const double high = ankleAt(t, foot.c_str()).y() - from.bones[static_cast<std::size_t>(boneOf(sourceRoles, foot))].head.y();
                            if (std::string(name) != "mannequin.glb" && !(high > 0.2)) continue;
                        }
                        const int s2 = boneOf(sourceRoles, side + pointing->second), b2 = boneOf(figureRoles, side + pointing->second);
                        if (s2 < 0 || b2 < 0) continue;
                        off = std::acos(std::clamp((headIn(p, s2) - headIn(p, s)).normalized().dot((headIn(q, b2) - headIn(q, b)).normalized()), -1.0, 1.0));
                    } else if (part == "Hand") {
                        // Against the arm.
                        const auto against = [&](const Rig& rig, const std::vector<RigPose>& pose, int hand, int arm) { return Turn(turnedIn(rig, pose, arm).conjugate() * turnedIn(rig, pose, hand)).angularDistance(Turn::Identity()); };
                        off = std::abs(against(from, p, s, boneOf(sourceRoles, side + "LowerArm")) - against(to, q, b, boneOf(figureRoles, side + "LowerArm")));
                    } else if (part.find("Thumb") == std::string::npos && part.find("Middle") == std::string::npos) {
                        off = turnedIn(from, p, s).angularDistance(turnedIn(to, q, b));
                    }
                    if (off > worst) worst = off, which = role.role;
                }
                for (int k = 0; motion && k < 2; ++k) {
                    // Planted: where the motion keeps the foot on the floor.
                    const Vec3 now = motion->foot(t / clip.seconds, k == 0);
                    const Vec3& ankle = headIn(q, boneOf(figureRoles, k == 0 ? "leftFoot" : "rightFoot"));
                    if (now.y() > 0.0 || (now - goal[static_cast<std::size_t>(k)]).norm() > 1e-9) stood[static_cast<std::size_t>(k)] = ankle;
                    goal[static_cast<std::size_t>(k)] = now;
                    slide = std::max(slide, (ankle - stood[static_cast<std::size_t>(k)]).norm());
                }
            }
            CAPTURE(which);
            CHECK(worst < 1.0 * kDegree);
            CHECK(slide < 0.01 * height);
            if (motion) CHECK(made.feet);
        }
    }
}
