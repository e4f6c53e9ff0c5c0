// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "core/commands/core_commands.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/cycle.h"
#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "core/document/names.h"
#include "core/document/source_calibration.h"
#include "core/live/live_character.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// What is nearer to its target than this is there, m.
constexpr double kHeld = 1e-5;

/// Errors: "no-such-pose" with the names there are.
Result<KeptPoses::const_iterator> poseNamed(const KeptPoses& poses, const std::string& name) {
    const auto found = std::find_if(poses.begin(), poses.end(), [&](const KeptPose& pose) { return pose.name == name; });
    if (found != poses.end()) return found;
    std::string there;
    for (const KeptPose& pose : poses) there += (there.empty() ? "\"" : ", \"") + pose.name + "\"";
    return fail("no-such-pose", "There is no pose \"" + name + "\"" + (there.empty() ? "; keep one by keep-pose." : "; there are " + there + "."));
}

std::string freePoseName(const KeptPoses& poses) {
    for (int n = 1;; ++n) {
        std::string name = "pose " + std::to_string(n);
        if (std::none_of(poses.begin(), poses.end(), [&](const KeptPose& pose) { return pose.name == name; })) return name;
    }
}

Result<Json> keepPose(DocumentEdit& edit, const Json& arguments, const Progress&) {
    KeptPoses poses = keptPoses(edit.document);
    std::string name = freePoseName(poses);
    if (const Json* given = find(arguments, "name")) {
        name = given->get_ref<const std::string&>();
        if (auto ok = checkNameText(name); !ok) return tl::unexpected(ok.error());
    }
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    if (plan->input.skeleton.bones.empty() && plan->handles.empty() && edit.document.turns.empty() && edit.document.morphs.empty())
        return fail("nothing-posed", "There are no bones and no handles yet: a pose is of them.");
    KeptPose pose = poseOf(edit.document, *plan);
    pose.name = name;
    const auto same = std::find_if(poses.begin(), poses.end(), [&](const KeptPose& p) { return p.name == name; });
    const bool replaced = same != poses.end();
    if (replaced)
        *same = std::move(pose);
    else if (poses.size() >= kMostKeptPoses)
        return fail("too-many-poses", "There are " + std::to_string(kMostKeptPoses) + " poses already: remove some.");
    else
        poses.push_back(std::move(pose));
    Json answer{{"name", name}, {"replaced", replaced}, {"poses", poses.size()}};
    setKeptPoses(edit.document, std::move(poses));
    return answer;
}

Result<Json> applyKept(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto pose, poseNamed(keptPoses(edit.document), text(arguments, "name")));
    double share = 1.0;
    if (auto ok = readNumber(arguments, "share", 0.0, 1.0, share); !ok) return tl::unexpected(ok.error());
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    std::vector<std::string> unpaired;
    const KeptPose to = arguments.value("mirrored", false) ? mirrored(*pose, edit.document, *plan, unpaired) : *pose;
    applyPose(edit.document, *plan, to, share);
    Json answer = Json::object();
    if (!unpaired.empty()) answer["unpaired"] = unpaired;
    return answer;
}

Result<Json> mirrorPose(DocumentEdit& edit, const Json&, const Progress&) {
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    std::vector<std::string> unpaired;
    applyPose(edit.document, *plan, mirrored(poseOf(edit.document, *plan), edit.document, *plan, unpaired), 1.0);
    Json answer = Json::object();
    if (!unpaired.empty()) answer["unpaired"] = unpaired;
    return answer;
}

/// Where bones were left between two poses, or sides are not alike, inverse kinematics have the last word.
Result<Json> showMended(LiveCharacter& live, const Json&, Json answer) {
    live.hidePositions();
    live.jumpToPose();
    if (!live.document().effects.has(EffectKind::BoneDynamics))
        if (auto solved = live.converge(); !solved) return tl::unexpected(solved.error());
    return answer;
}

Result<Json> showKept(LiveCharacter& live, const Json& arguments, Json answer) {
    if (arguments.value("share", 1.0) < 1.0 || arguments.value("mirrored", false)) return showMended(live, arguments, std::move(answer));
    live.hidePositions();
    live.jumpToPose();
    return answer;
}

/// The bones stay as they were brought there, unless something is held elsewhere.
Result<Json> showRested(LiveCharacter& live, const Json& arguments, Json answer) {
    const Document& document = live.document();
    const bool held = std::any_of(document.goals.begin(), document.goals.end(), [&](const auto& goal) {
        const int point = live.plan().pointIndex(goal.first);
        return point >= 0 && std::size_t(point) < document.pose.points.size() && (document.pose.points[std::size_t(point)] - goal.second.target).norm() > kHeld;
    });
    if (held) return showMended(live, arguments, std::move(answer));
    live.hidePositions();
    live.jumpToPose();
    return answer;
}

Result<Json> restSome(DocumentEdit& edit, const Json& arguments, const Progress&) {
    std::set<PartId> bones;
    for (const Json& name : arguments.at("bones")) {
        if (!name.is_string()) return fail("bad-type", "\"bones\" must be names of bones.");
        IMOMUSHI_TRY(const auto bone, boneOf(edit.document, name.get_ref<const std::string&>()));
        bones.insert(bone->id);
    }
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    if (arguments.value("chain", false)) bones = withChains(*plan, std::move(bones));
    restBones(edit.document, *plan, bones);
    return Json{{"bones", bones.size()}};
}

Result<Json> renamePose(DocumentEdit& edit, const Json& arguments, const Progress&) {
    KeptPoses poses = keptPoses(edit.document);
    IMOMUSHI_TRY(const auto pose, poseNamed(poses, text(arguments, "pose")));
    const std::string& name = text(arguments, "name");
    if (name == pose->name) return Json::object();
    if (auto ok = checkNameText(name); !ok) return tl::unexpected(ok.error());
    if (keptPose(edit.document, name)) return fail("name-taken", "There is a pose \"" + name + "\" already: choose another name.");
    renameMapped(edit.document, "pose", pose->name, name);
    renamePoseInCycles(edit.document, pose->name, name);
    renamePoseInCalibrations(edit.document, pose->name, name);
    poses[std::size_t(pose - poses.begin())].name = name;
    setKeptPoses(edit.document, std::move(poses));
    return Json::object();
}

Result<Json> removePose(DocumentEdit& edit, const Json& arguments, const Progress&) {
    KeptPoses poses = keptPoses(edit.document);
    IMOMUSHI_TRY(const auto pose, poseNamed(poses, text(arguments, "pose")));
    // A gait without one of its poses would be another one, and nobody asked for that.
    if (const auto through = cyclesThrough(edit.document, pose->name); !through.empty())
        return fail("pose-in-cycle", "The pose \"" + pose->name + "\" belongs to the cycle \"" + through.front() + "\": remove that cycle, or give it other poses, first.");
    const auto uncalibrated = dropPoseFromCalibrations(edit.document, pose->name);
    poses.erase(pose);
    setKeptPoses(edit.document, std::move(poses));
    return uncalibrated.empty() ? Json::object() : Json{{"uncalibrated", uncalibrated}};
}

}  // namespace

void addKeptPoseCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("keep-pose", "Keeps the pose by a name: bones, what holds them, handles, turned parts and morph targets. It is saved with the project; one of that name is replaced.",
                       {{"name", Type::Text, false, "Its name (\"pose 1\", ...)."}}, keepPose);
    registry.addChange("apply-pose", "Poses the character as a kept pose, at once. What is not there any more takes no part in it.",
                       {{"name", Type::Text, true, "The kept pose."},
                        {"share", Type::Number, false, "How far on the way there, 0 to 1 (1)."},
                        {"mirrored", Type::Boolean, false, "With left and right exchanged, by names like \"arm.L\" and \"arm.R\" (false). \"unpaired\" in the answer: what has a side and nothing on the other one, and is as it was kept."}},
                       applyKept, showKept);
    registry.addChange("mirror-pose", "Exchanges left and right of the pose, by names like \"arm.L\" and \"arm.R\"; what is in the middle is mirrored in itself. \"unpaired\" in the answer: what has a side and nothing on the other one, and stays.", {}, mirrorPose, showMended);
    registry.addChange("rest-bones", "Brings bones back to rest against their parents; what hangs on them goes along. Targets there are let go, pins are not.",
                       {{"bones", Type::Array, true, "Their names."}, {"chain", Type::Boolean, false, "With all bones that hang on them (false)."}}, restSome, showRested);
    registry.addChange("rename-pose", "Renames a kept pose; mappings, cycles and calibrations follow.", {{"pose", Type::Text, true, "Its name."}, {"name", Type::Text, true, "A name that no kept pose has."}}, renamePose);
    registry.addChange("remove-pose", "Removes a kept pose that no cycle goes through; calibrations lose it (\"uncalibrated\" in the answer: of these sources).", {{"pose", Type::Text, true, "Its name."}}, removePose);
}

}  // namespace imomushi
