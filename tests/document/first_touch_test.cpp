// SPDX-License-Identifier: GPL-3.0-or-later
// The first touch: each free end of a character that stands is dragged by a fifth of its height in six directions. The limb follows, the trunk stays upright, the feet stay where they are.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "tests/document/workbench.h"

using namespace imomushi;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Bones by name, with where their ends are.
using Ends = std::map<std::string, std::array<Vec3, 2>>;

Ends endsOf(Session& session) {
    Ends ends;
    for (const auto& [id, bone] : session.document().bones) ends[bone->name] = {session.positionOf({id, false}).value(), session.positionOf({id, true}).value()};
    return ends;
}

double turned(const std::array<Vec3, 2>& from, const std::array<Vec3, 2>& to) {
    const Vec3 a = from[1] - from[0], b = to[1] - to[0];
    return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b));
}

struct Touched {
    int drags = 0;
    double trunk = 0.0;  ///< degrees, largest turn of a bone of the trunk
    double feet = 0.0;   ///< of the height, largest move of a pinned end
    double missed = 0.0; ///< of the drag, largest distance of the end from where it was dragged
    double stretched = 0.0;  ///< largest strain of a bone
    int trunkFirst = 0;  ///< drags in which the trunk turned more than the bones of the limb did at most
    std::string worst;
};

/// Degrees by which bones turn together, as a frame: the best rotation of all of them.
double turnedTogether(const Ends& from, const Ends& to, const std::vector<std::string>& bones) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const std::string& name : bones) {
        const auto &a = from.at(name), &b = to.at(name);
        sum += (b[1] - b[0]) * (a[1] - a[0]).transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);
    return kDegrees * Eigen::AngleAxisd(u * svd.matrixV().transpose()).angle();
}

/// So many bones of a trunk meet in its middle: they are a frame.
constexpr std::size_t kFrame = 4;

/// `trunk`: its bones.
Touched touch(Workbench& w, const std::vector<std::string>& trunk, double height) {
    Touched out;
    const Ends rest = endsOf(w.session);
    const Document document = w.session.document();
    for (const auto& [id, bone] : document.bones) {
        const Vec3 at = rest.at(bone->name)[1];
        const bool free = std::none_of(document.bones.begin(), document.bones.end(), [&](const auto& other) {
            return other.first != id && ((rest.at(other.second->name)[0] - at).norm() < 1e-9 || (rest.at(other.second->name)[1] - at).norm() < 1e-9);
        });
        if (!free || document.goals.contains({id, true})) continue;
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                const Vec3 to = at + 0.2 * height * sign * Vec3::Unit(axis);
                w.good({{"do", "drag"}, {"endpoint", bone->name + "/end"}, {"to", {to.x(), to.y(), to.z()}}});
                w.good({{"do", "step"}, {"frames", 120}});
                const Ends now = endsOf(w.session);
                double lean = 0.0, limb = 0.0;
                if (trunk.size() >= kFrame)
                    lean = turnedTogether(rest, now, trunk);
                else
                    for (const std::string& name : trunk) lean = std::max(lean, turned(rest.at(name), now.at(name)));
                for (const auto& [name, ends] : rest)
                    if (std::find(trunk.begin(), trunk.end(), name) == trunk.end()) limb = std::max(limb, turned(ends, now.at(name)));
                for (const auto& [name, ends] : rest)
                    out.stretched = std::max(out.stretched, std::abs((now.at(name)[1] - now.at(name)[0]).norm() / (ends[1] - ends[0]).norm() - 1.0));
                if (lean > out.trunk) out.trunk = lean, out.worst = bone->name + " " + (sign < 0.0 ? "-" : "+") + "xyz"[axis];
                if (lean > limb) ++out.trunkFirst;
                for (const auto& [id2, goal] : document.goals) {
                    if (!goal.pinned) continue;
                    const std::string& foot = document.bones.at(id2.bone)->name;
                    const int e = id2.atEnd ? 1 : 0;
                    out.feet = std::max(out.feet, (now.at(foot)[static_cast<std::size_t>(e)] - rest.at(foot)[static_cast<std::size_t>(e)]).norm() / height);
                }
                out.missed = std::max(out.missed, (now.at(bone->name)[1] - to).norm() / (0.2 * height));
                ++out.drags;
                w.good({{"do", "release"}});
                w.good({{"do", "rest"}});
            }
    }
    return out;
}

/// `trunk`: its bones.
void checkTouch(Workbench& w, const std::string& name, const std::vector<std::string>& trunk) {
    double low = 1e300, high = -1e300;
    for (const auto& [id, element] : w.session.document().elements) {
        low = std::min(low, element->mesh->body.vertices.col(1).minCoeff());
        high = std::max(high, element->mesh->body.vertices.col(1).maxCoeff());
    }
    std::string names;
    for (const std::string& one : trunk) names += " " + one;
    const double given = w.session.document().settings.bodyFollows;
    for (const double follows : {0.0, given > 0.0 ? given : 1.0}) {
        w.good({{"do", "set"}, {"target", "character"}, {"property", "body-follows"}, {"value", follows}});
        const Touched t = touch(w, trunk, high - low);
        MESSAGE(name << ": body follows " << follows << ", " << t.drags << " drags, trunk" << names << " turns " << t.trunk << " degrees (" << t.worst << "), bones stretch by " << 100.0 * t.stretched << " %, feet move " << 100.0 * t.feet
                     << " % of the height, ends miss " << 100.0 * t.missed << " % of the drag, trunk first " << t.trunkFirst);
        if (follows == 0.0) continue;
        CHECK(t.drags > 0);
        CHECK(t.trunk < 15.0);
        CHECK(t.feet < 0.01);
        CHECK(t.trunkFirst == 0);
        CHECK(t.missed < 0.1);
    }
}

void checkSample(const std::string& sample, const std::vector<std::string>& trunk) {
    Workbench w;
    w.good({{"do", "open"}, {"path", std::string(IMOMUSHI_SAMPLES) + "/" + sample + ".imomushi"}});
    for (const char* effect : {"bone-dynamics", "ground"})
        if (w.session.document().effects.has(*effectNamed(effect))) w.good({{"do", "disable"}, {"effect", effect}});
    checkTouch(w, sample, trunk);
}

/// Made soft and alive, not precomputed: bones alone move.
void checkStranger(const std::string& name, const std::vector<std::string>& trunk) {
    Workbench w;
    w.session.services().importCharacter = importCharacter;
    const Json made = w.good({{"do", "make-soft"}, {"path", IMOMUSHI_TEST_DATA "/characters/" + name + ".glb"}, {"precompute", false}, {"alive", true}});
    CHECK(made["refused"].empty());
    CHECK(w.session.document().settings.bodyFollows == 1.0);
    for (const EffectKind kind : {EffectKind::BendWarp, EffectKind::SmoothJoints, EffectKind::EndStretch, EffectKind::BoneDynamics, EffectKind::Ground}) CHECK(w.session.document().effects.has(kind));
    for (const char* effect : {"bone-dynamics", "ground"}) w.good({{"do", "disable"}, {"effect", effect}});
    checkTouch(w, name, trunk);
}

/// From its shape alone, where the third-party file is there. Bones whose names hold `trunk` and that run through the piece of that name are its trunk.
void checkShape(const std::string& file, const std::string& trunk, std::size_t feet) {
    const std::filesystem::path path = std::filesystem::path(IMOMUSHI_SHARED_MESHES) / file;
    if (!std::filesystem::exists(path)) {
        MESSAGE(file << " is not there");
        return;
    }
    Workbench w;
    w.session.services().importCharacter = importCharacter;
    const Json made = w.good({{"do", "make-soft"}, {"path", path.string()}, {"precompute", false}, {"alive", true}, {"from", "shape"}});
    CHECK(made["refused"].empty());
    CHECK(w.session.document().settings.bodyFollows == 1.0);
    CHECK(w.session.document().goals.size() == feet);
    for (const char* effect : {"bone-dynamics", "ground"}) w.good({{"do", "disable"}, {"effect", effect}});
    std::vector<std::string> bones;
    for (const auto& [id, bone] : w.session.document().bones)
        if (bone->name.find(trunk) != std::string::npos && w.session.document().elements.contains(bone->element) && w.session.document().elements.at(bone->element)->name == "trunk") bones.push_back(bone->name);
    CHECK(!bones.empty());
    checkTouch(w, file, bones);
}

/// How a limb of two bones folds.
struct Fold {
    Vec3 joint;            ///< heights: of the knee or elbow, from the middle between both ends of the limb
    double bend = 0.0;     ///< degrees between upper and lower
    double shorter = 0.0;  ///< largest part of its length by which one of the two is shorter
    double moved = 0.0;    ///< heights: by the start of the limb
    double missed = 0.0;   ///< heights: from its end to where it was dragged
};
/// Drags the end of `lower` to `to`, m, and lets it go again. `height`: of the character, m.
Fold fold(Workbench& w, const std::string& upper, const std::string& lower, const Vec3& to, double height) {
    const Ends rest = endsOf(w.session);
    w.good({{"do", "drag"}, {"endpoint", lower + "/end"}, {"to", {to.x(), to.y(), to.z()}}});
    w.good({{"do", "step"}, {"frames", 240}});
    const Ends now = endsOf(w.session);
    const auto &u = now.at(upper), &l = now.at(lower);
    Fold out;
    out.joint = (l[0] - 0.5 * (u[0] + l[1])) / height;
    out.bend = turned(u, l);
    for (const auto& name : {upper, lower}) out.shorter = std::max(out.shorter, 1.0 - (now.at(name)[1] - now.at(name)[0]).norm() / (rest.at(name)[1] - rest.at(name)[0]).norm());
    out.moved = (u[0] - rest.at(upper)[0]).norm() / height;
    out.missed = (l[1] - to).norm() / height;
    MESSAGE(upper << " and " << lower << " bend by " << out.bend << " degrees, joint at " << out.joint.transpose() << ", shorter by " << 100.0 * out.shorter << " %, the limb's root moves by " << 100.0 * out.moved
                  << " %, missed by " << 100.0 * out.missed << " % of the height");
    w.good({{"do", "release"}, {"endpoint", lower + "/end"}});
    w.good({{"do", "rest"}});
    return out;
}

struct Limbs {
    std::string name, upperLeg, lowerLeg, upperArm, lowerArm;  ///< "L" or "Left" stands where # is
    double height = 0.0;
};

}  // namespace

TEST_CASE("first touch: knees of a human go forward where its ankle is pushed up, elbows so that the forearm goes forward") {
    for (const Limbs& limbs : {Limbs{"mannequin.glb", "rig:#UpLeg", "rig:#Leg", "rig:#Arm", "rig:#ForeArm", 1.79}, Limbs{"avatar.glb", "upperLeg.#", "lowerLeg.#", "upperArm.#", "lowerArm.#", 1.46}}) {
        Workbench w;
        w.session.services().importCharacter = importCharacter;
        w.good({{"do", "make-soft"}, {"path", IMOMUSHI_TEST_DATA "/characters/" + limbs.name}, {"precompute", false}, {"alive", true}});
        for (const char* effect : {"bone-dynamics", "ground"}) w.good({{"do", "disable"}, {"effect", effect}});
        const Ends rest = endsOf(w.session);
        for (const bool left : {true, false}) {
            const auto side = [&](std::string name) { return name.replace(name.find('#'), 1, name.starts_with("rig") ? (left ? "Left" : "Right") : (left ? "L" : "R")); };
            const Vec3 ankle = rest.at(side(limbs.lowerLeg))[1];
            const Fold knee = fold(w, side(limbs.upperLeg), side(limbs.lowerLeg), ankle + Vec3(0, 0.2 * limbs.height, 0), limbs.height);
            CHECK(knee.joint.z() > 0.05);
            CHECK(std::abs(knee.joint.x()) < 0.03);
            CHECK(knee.bend > 45.0);
            CHECK(knee.shorter < 0.05);
            const Vec3 shoulder = rest.at(side(limbs.upperArm))[0], wrist = rest.at(side(limbs.lowerArm))[1];
            const Fold elbow = fold(w, side(limbs.upperArm), side(limbs.lowerArm), 0.4 * wrist + 0.6 * shoulder, limbs.height);
            CHECK(elbow.joint.z() < -0.05);
            CHECK(elbow.bend > 75.0);
            CHECK(elbow.shorter < 0.05);
            CHECK(elbow.moved < 0.1);  // 16 % without hinges
        }
    }
}

TEST_CASE("first touch: what is made alive has its effects, and without the key nothing is enabled") {
    const std::string file = IMOMUSHI_TEST_DATA "/characters/panda.glb";
    Workbench w;
    w.session.services().importCharacter = importCharacter;
    w.good({{"do", "make-soft"}, {"path", file}, {"precompute", false}});
    CHECK(w.session.document().settings.bodyFollows == 0.0);
    for (std::size_t k = 0; k < kEffects; ++k) CHECK_FALSE(w.session.document().effects.has(static_cast<EffectKind>(k)));
}

TEST_CASE("first touch: who is pushed down by a fifth of the height stays finite, also where the flesh has needles") {
    Workbench w;
    w.session.services().importCharacter = importCharacter;
    w.good({{"do", "make-soft"}, {"path", IMOMUSHI_TEST_DATA "/characters/mannequin.glb"}, {"alive", true}, {"draft", true}, {"precompute", false}});
    w.good({{"do", "disable"}, {"effect", "bone-dynamics"}});
    const Vec3 hips = endsOf(w.session).at("rig:Hips")[0];
    w.good({{"do", "drag"}, {"endpoint", "rig:Hips/start"}, {"to", {hips.x(), hips.y() - 0.35, hips.z()}}});  // the bend warp of a foot overflowed
    w.good({{"do", "step"}, {"frames", 10}});
    const Json box = w.good({{"do", "measure"}, {"what", "bounds"}})["value"];
    for (const char* corner : {"low", "high"})
        for (const Json& x : box[corner]) CHECK(std::abs(x.get<double>()) < 2.0);  // m; it is 1.8 tall
}

TEST_CASE("first touch: characters of others that stand keep their trunks upright and their feet where they are") {
    checkStranger("mannequin", {"rig:Hips", "rig:Spine"});
    checkStranger("avatar", {"hips", "spine"});
    checkStranger("panda", {"hips to spine1", "spine1"});
}

TEST_CASE("first touch: four-legged strangers without a rig keep their trunks upright and their feet where they are") {
    checkShape("spot.obj", "base", 4);
    checkShape("model-horse.glb", "trunk bone", 4);
    checkShape("penguin.obj", "trunk bone", 2);
}

TEST_CASE("first touch: samples that stand keep their trunks upright and their feet where they are") {
    checkSample("figure", {"spine-bone"});
    checkSample("dragon", {"root"});
}
