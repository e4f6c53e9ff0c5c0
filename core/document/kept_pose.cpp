// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/kept_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/finite.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/morph_weights.h"
#include "core/document/side_names.h"
#include "core/mesh/render_model.h"

namespace imomushi {

namespace {

Pose posed(const Document& document, const CharacterPlan& plan) {
    const Skeleton& skeleton = plan.input.skeleton;
    const Pose& pose = document.pose;
    const bool fits = pose.points.size() == skeleton.points.size() && pose.frames.size() == skeleton.bones.size() && pose.roll.size() == skeleton.points.size();
    return fits ? pose : restPose(skeleton);
}

/// Of a goal where it is now.
EndpointGoal still(const EndpointGoal& goal) {
    EndpointGoal made = goal;
    if (goal.seconds > 0.0) {
        const double part = std::clamp(goal.elapsed / goal.seconds, 0.0, 1.0);
        made.target = goal.from + part * (goal.target - goal.from);
        if (goal.roll) made.roll = goal.fromRoll + part * (*goal.roll - goal.fromRoll);
    }
    made.seconds = made.elapsed = 0.0;
    made.from = made.target;
    return made;
}

HandleGoal still(const HandleGoal& goal) {
    HandleGoal made;
    made.pinned = goal.pinned;
    made.target = made.from = goal.now();
    return made;
}

Eigen::Quaterniond between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double share) { return a.slerp(share, b).normalized(); }

Eigen::Quaterniond quaternion(const std::array<double, 4>& q) { return {q[3], q[0], q[1], q[2]}; }
std::array<double, 4> numbers(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

Vec3 reflected(const Vec3& v) { return {-v.x(), v.y(), v.z()}; }
Eigen::Quaterniond reflected(const Eigen::Quaterniond& q) { return {q.w(), q.x(), -q.y(), -q.z()}; }

}  // namespace

KeptPose poseOf(const Document& document, const CharacterPlan& plan) {
    KeptPose kept;
    const Pose pose = posed(document, plan);
    const auto& bones = plan.input.skeleton.bones;
    for (std::size_t b = 0; b < bones.size(); ++b) {
        const auto start = static_cast<std::size_t>(bones[b].start), end = static_cast<std::size_t>(bones[b].end);
        kept.bones.emplace(plan.bones[b], KeptPose::Bone{pose.points[start], pose.points[end], pose.frames[b], pose.roll[start], pose.roll[end]});
    }
    for (const auto& [end, goal] : document.goals) kept.goals.emplace(end, still(goal));
    for (const auto& [handle, goal] : document.handleGoals) kept.handles.emplace(handle, still(goal));
    for (const auto& [part, turn] : document.turns) kept.turns.emplace(part, turn.now());
    kept.morphs = document.morphs;
    return kept;
}

void applyPose(Document& document, const CharacterPlan& plan, const KeptPose& kept, double share) {
    const bool all = share >= 1.0;
    const auto& skeleton = plan.input.skeleton;
    const Pose before = posed(document, plan);
    Pose pose = before;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto found = kept.bones.find(plan.bones[b]);
        if (found == kept.bones.end()) continue;
        const auto start = static_cast<std::size_t>(skeleton.bones[b].start), end = static_cast<std::size_t>(skeleton.bones[b].end);
        const auto go = [&](std::size_t point, const Vec3& to, double roll) {
            pose.points[point] = all ? to : Vec3(before.points[point] + share * (to - before.points[point]));
            pose.roll[point] = all ? roll : before.roll[point] + share * (roll - before.roll[point]);
        };
        go(start, found->second.start, found->second.startRoll);
        go(end, found->second.end, found->second.endRoll);
        pose.frames[b] = all ? found->second.frame : between(before.frames[b], found->second.frame, share);
    }
    document.pose = pose;
    document.touches.clear();

    const auto wasAt = [&](const EndpointRef& end) -> std::optional<Vec3> {
        const int point = plan.pointIndex(end);
        if (point < 0) return std::nullopt;
        return before.points[static_cast<std::size_t>(point)];
    };
    std::map<EndpointRef, EndpointGoal> goals;
    for (const auto& [end, goal] : kept.goals) {
        const auto from = wasAt(end);
        if (!from) continue;
        EndpointGoal made = goal;
        if (!all) {
            const auto now = document.goals.find(end);
            const EndpointGoal held = now == document.goals.end() ? EndpointGoal{} : still(now->second);
            const Vec3 at = now == document.goals.end() ? *from : held.target;
            made.target = made.from = at + share * (goal.target - at);
            if (goal.roll) made.roll = (1.0 - share) * held.roll.value_or(before.roll[static_cast<std::size_t>(plan.pointIndex(end))]) + share * *goal.roll;
            if (goal.rotation && held.rotation) made.rotation = numbers(between(quaternion(*held.rotation), quaternion(*goal.rotation), share));
        }
        goals.emplace(end, made);
    }
    if (!all)
        for (const auto& [end, goal] : document.goals) {
            if (goals.contains(end)) continue;
            EndpointGoal made = still(goal);
            const auto bone = kept.bones.find(end.bone);
            if (bone != kept.bones.end()) made.target += share * ((end.atEnd ? bone->second.end : bone->second.start) - made.target);
            made.from = made.target;
            goals.emplace(end, made);
        }
    document.goals = std::move(goals);

    std::map<FaceRef, HandleGoal> handles;
    for (const auto& [handle, goal] : kept.handles) {
        if (plan.handleIndex(handle) < 0) continue;
        HandleGoal made = goal;
        const auto now = document.handleGoals.find(handle);
        if (!all && now != document.handleGoals.end() && now->second.target.held == goal.target.held) {
            const HandlePose from = now->second.now();
            made.target.at = from.at + share * (goal.target.at - from.at);
            made.target.rotation = between(from.rotation, goal.target.rotation, share);
            made.from = made.target;
        }
        handles.emplace(handle, made);
    }
    document.handleGoals = std::move(handles);

    std::map<PartRef, TurnGoal> turns;
    const auto turn = [&](const PartRef& part, const Eigen::Quaterniond& to) {
        const auto now = document.turns.find(part);
        const Eigen::Quaterniond from = now == document.turns.end() ? Eigen::Quaterniond::Identity() : now->second.now();
        TurnGoal made;
        made.target = made.from = all ? to : between(from, to, share);
        if (document.characters.contains(part.character)) turns.emplace(part, made);
    };
    for (const auto& [part, to] : kept.turns) turn(part, to);
    if (!all)
        for (const auto& [part, now] : document.turns)
            if (!kept.turns.contains(part)) turn(part, Eigen::Quaterniond::Identity());
    document.turns = std::move(turns);

    std::map<MorphRef, double> morphs;
    const auto weigh = [&](const MorphRef& morph, std::optional<double> to) {
        const auto character = document.characters.find(morph.character);
        if (character == document.characters.end() || morph.target < 0 || std::size_t(morph.target) >= character->second->model->morphs.size()) return;
        const double rest = character->second->model->morphs[std::size_t(morph.target)].atRest, from = morphWeight(document, *character->second, morph.target);
        const double weight = all ? to.value_or(rest) : from + share * (to.value_or(rest) - from);
        if (weight != rest) morphs.emplace(morph, weight);
    };
    for (const auto& [morph, weight] : kept.morphs) weigh(morph, weight);
    if (!all)
        for (const auto& [morph, weight] : document.morphs)
            if (!kept.morphs.contains(morph)) weigh(morph, std::nullopt);
    document.morphs = std::move(morphs);
}

KeptPose mirrored(const KeptPose& pose, const Document& document, const CharacterPlan& plan, std::vector<std::string>& unpaired) {
    const Skeleton& skeleton = plan.input.skeleton;
    KeptPose made = pose;
    // The bone of the other side; itself in the middle; none: it has a side, and is alone.
    const auto otherOf = [&](PartId id) -> std::optional<PartId> {
        const auto bone = document.bones.find(id);
        if (bone == document.bones.end()) return std::nullopt;
        const std::string name = otherSide(bone->second->name);
        if (name == bone->second->name) return id;
        const Bone* other = document.boneNamed(name);
        return other ? std::optional(other->id) : std::nullopt;
    };
    const auto restOf = [&](const EndpointRef& end) -> std::optional<Vec3> {
        const int point = plan.pointIndex(end);
        if (point < 0) return std::nullopt;
        return skeleton.points[static_cast<std::size_t>(point)];
    };
    const auto carried = [](const Vec3& at, const Vec3& rest, const Vec3& otherRest) { return Vec3(otherRest + reflected(Vec3(at - rest))); };
    made.bones.clear();
    for (const auto& [id, was] : pose.bones) {
        const auto bone = document.bones.find(id);
        if (bone == document.bones.end()) continue;
        const auto other = otherOf(id);
        const auto from = other ? pose.bones.find(*other) : pose.bones.end();
        const auto start = restOf({id, false}), end = restOf({id, true});
        const auto otherStart = other ? restOf({*other, false}) : std::nullopt, otherEnd = other ? restOf({*other, true}) : std::nullopt;
        if (from == pose.bones.end() || !start || !end || !otherStart || !otherEnd) {
            unpaired.push_back(bone->second->name);
            made.bones.emplace(id, was);
            continue;
        }
        const KeptPose::Bone& o = from->second;
        made.bones.emplace(id, KeptPose::Bone{carried(o.start, *otherStart, *start), carried(o.end, *otherEnd, *end), reflected(o.frame), -o.startRoll, -o.endRoll});
    }
    made.goals.clear();
    for (const auto& [end, goal] : pose.goals) {
        const auto other = otherOf(end.bone);
        const auto rest = restOf(end), otherRest = other ? restOf({*other, end.atEnd}) : std::nullopt;
        EndpointGoal to = goal;
        if (rest && otherRest) {
            to.target = to.from = carried(goal.target, *rest, *otherRest);
            if (goal.roll) to.roll = -*goal.roll;
            if (goal.rotation) to.rotation = numbers(reflected(quaternion(*goal.rotation)));
        }
        made.goals.insert_or_assign(rest && otherRest ? EndpointRef{*other, end.atEnd} : end, to);
    }
    made.handles.clear();
    for (const auto& [handle, goal] : pose.handles) {
        const std::string name = otherSide(handle.face);
        const auto other = name == handle.face ? std::optional(handle) : document.handle(name);
        const int index = plan.handleIndex(handle), to = other ? plan.handleIndex(*other) : -1;
        HandleGoal held = goal;
        if (index < 0 || to < 0) {
            unpaired.push_back(handle.face);
            made.handles.insert_or_assign(handle, held);
            continue;
        }
        const auto originOf = [&](const FaceRef& ref) {
            const Element& element = *document.elements.at(ref.element);
            return element.faces[static_cast<std::size_t>(element.faceIndex(ref.face))].frame.origin;
        };
        held.target.at = carried(goal.target.at, originOf(handle), originOf(*other));
        held.target.rotation = reflected(goal.target.rotation);
        held.from = held.target;
        made.handles.insert_or_assign(*other, held);
    }
    made.turns.clear();
    for (const auto& [part, turn] : pose.turns) {
        const auto character = document.characters.find(part.character);
        if (character == document.characters.end()) continue;
        const ModelParts& parts = character->second->model->namedParts();
        const auto other = parts.find(otherSide(parts.nameOf(part.part)));
        made.turns.insert_or_assign(other ? PartRef{part.character, *other} : part, reflected(turn));
    }
    made.morphs.clear();
    for (const auto& [morph, weight] : pose.morphs) {
        const auto character = document.characters.find(morph.character);
        if (character == document.characters.end() || morph.target < 0) continue;
        const auto& targets = character->second->model->morphs;
        if (std::size_t(morph.target) >= targets.size()) continue;
        const std::string name = otherSide(targets[std::size_t(morph.target)].name);
        const auto found = std::find_if(targets.begin(), targets.end(), [&](const auto& target) { return target.name == name; });
        made.morphs.insert_or_assign(found == targets.end() ? morph : MorphRef{morph.character, std::int32_t(found - targets.begin())}, weight);
    }
    return made;
}

std::set<PartId> withChains(const CharacterPlan& plan, std::set<PartId> bones) {
    const auto& all = plan.input.skeleton.bones;
    for (std::size_t b = 0; b < all.size(); ++b)  // parents come before their children
        if (all[b].parent >= 0 && bones.contains(plan.bones[static_cast<std::size_t>(all[b].parent)])) bones.insert(plan.bones[b]);
    return bones;
}

void restBones(Document& document, const CharacterPlan& plan, const std::set<PartId>& bones) {
    const Skeleton& skeleton = plan.input.skeleton;
    const Pose before = posed(document, plan);
    Pose pose = before;
    std::vector<bool> placed(skeleton.points.size(), false);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const Skeleton::Bone& bone = skeleton.bones[b];
        const bool rests = bones.contains(plan.bones[b]);
        const Eigen::Quaterniond parentWas = bone.parent < 0 ? Eigen::Quaterniond::Identity() : before.frames[static_cast<std::size_t>(bone.parent)];
        const Eigen::Quaterniond parent = bone.parent < 0 ? Eigen::Quaterniond::Identity() : pose.frames[static_cast<std::size_t>(bone.parent)];
        pose.frames[b] = rests ? parent : (parent * parentWas.conjugate() * before.frames[b]).normalized();
        auto near = static_cast<std::size_t>(bone.start), far = static_cast<std::size_t>(bone.end);
        if (placed[far] && !placed[near]) std::swap(near, far);
        placed[near] = true;
        if (rests) pose.roll[far] = bone.parent < 0 ? (pose.roll[near] = 0.0) : 0.0;
        if (placed[far]) continue;
        placed[far] = true;
        const Vec3 arm = rests ? Vec3(skeleton.points[far] - skeleton.points[near]) : Vec3(before.frames[b].conjugate() * (before.points[far] - before.points[near]));
        pose.points[far] = pose.points[near] + pose.frames[b] * arm;
    }
    document.pose = pose;
    std::erase_if(document.goals, [&](const auto& held) {
        const int point = plan.pointIndex(held.first);
        return !held.second.pinned && point >= 0 && pose.points[static_cast<std::size_t>(point)] != before.points[static_cast<std::size_t>(point)];
    });
}

const KeptPoses& keptPoses(const Document& document) {
    static const KeptPoses kNone;
    return document.poses ? *document.poses : kNone;
}

const KeptPose* keptPose(const Document& document, std::string_view name) {
    const KeptPoses& all = keptPoses(document);
    const auto found = std::find_if(all.begin(), all.end(), [&](const KeptPose& pose) { return pose.name == name; });
    return found == all.end() ? nullptr : &*found;
}

void setKeptPoses(Document& document, KeptPoses poses) { document.poses = poses.empty() ? nullptr : std::make_shared<const KeptPoses>(std::move(poses)); }

// ---- as a project keeps them ---------------------------------------------------------------------------------------------

namespace {

constexpr double kMostRoll = 1e6;  // radians

Json turnJson(const Eigen::Quaterniond& q) { return Json::array({q.x(), q.y(), q.z(), q.w()}); }

/// Reads what nobody trusts: whatever is not as it must be makes it false.
struct PoseReader {
    bool good = true;
    Vec3 place(const Json& json) {
        const auto v = vector3(json);
        good = good && v;
        return v.value_or(Vec3(Vec3::Zero()));
    }
    Eigen::Quaterniond turn(const Json& json) {
        // As it was, to the last digit.
        Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
        if (!json.is_array() || json.size() != 4) return good = false, q;
        for (int i = 0; i < 4; ++i) q.coeffs()[i] = number(json[std::size_t(i)], 2.0);
        good = good && std::abs(q.norm() - 1.0) < 1e-6;
        return q;
    }
    double number(const Json& json, double most) {
        const bool ok = json.is_number() && std::abs(json.get<double>()) <= most;
        good = good && ok;
        return ok ? json.get<double>() : 0.0;
    }
    bool flag(const Json& json) {
        good = good && json.is_boolean();
        return json.is_boolean() && json.get<bool>();
    }
    std::int32_t whole(const Json& json) {
        const bool ok = json.is_number_integer() && json.get<std::int64_t>() >= -1 && json.get<std::int64_t>() <= std::int64_t{1} << 30;
        good = good && ok;
        return ok ? json.get<std::int32_t>() : 0;
    }
    PartId id(const Json& json) {
        const bool ok = json.is_number_integer() && json.get<std::int64_t>() >= 1 && json.get<std::int64_t>() <= std::int64_t{1} << 53;
        good = good && ok;
        return ok ? json.get<PartId>() : 0;
    }
    std::string word(const Json& json) {
        good = good && json.is_string();
        return json.is_string() ? json.get<std::string>() : std::string();
    }
    /// Each line of a list, of so many values at least.
    template <class Act>
    void lines(const Json& pose, const char* key, std::size_t values, const Act& act) {
        const auto list = pose.find(key);
        if (list == pose.end() || !list->is_array()) return void(good = false);
        for (const Json& line : *list) {
            if (!good || !line.is_array() || line.size() < values) return void(good = false);
            act(line);
        }
    }
};

}  // namespace

Json keptPosesJson(const KeptPoses& poses) {
    Json list = Json::array();
    for (const KeptPose& pose : poses) {
        Json bones = Json::array(), goals = Json::array(), handles = Json::array(), turns = Json::array(), morphs = Json::array();
        for (const auto& [id, b] : pose.bones) bones.push_back(Json::array({id, json(b.start), json(b.end), turnJson(b.frame), b.startRoll, b.endRoll}));
        for (const auto& [end, g] : pose.goals)
            goals.push_back(Json::array({end.bone, end.atEnd, g.pinned, json(g.target), g.roll ? Json(*g.roll) : Json(), g.rotation ? turnJson(quaternion(*g.rotation)) : Json()}));
        for (const auto& [handle, g] : pose.handles) handles.push_back(Json::array({handle.element, handle.face, g.pinned, g.target.held, json(g.target.at), turnJson(g.target.rotation)}));
        for (const auto& [part, q] : pose.turns) turns.push_back(Json::array({part.character, part.part.part, part.part.shell, turnJson(q)}));
        for (const auto& [morph, weight] : pose.morphs) morphs.push_back(Json::array({morph.character, morph.target, weight}));
        list.push_back({{"name", pose.name}, {"bones", bones}, {"goals", goals}, {"handles", handles}, {"turns", turns}, {"morphs", morphs}});
    }
    return list;
}

Result<KeptPoses> keptPosesFrom(const Json& list) {
    const auto broken = [] { return fail("bad-pose", "A kept pose is broken."); };
    if (!list.is_array()) return broken();
    KeptPoses poses;
    for (const Json& line : list) {
        if (!line.is_object() || !line.contains("name")) return broken();
        PoseReader in;
        KeptPose pose;
        pose.name = in.word(line["name"]);
        in.lines(line, "bones", 6, [&](const Json& v) {
            pose.bones.insert_or_assign(in.id(v[0]), KeptPose::Bone{in.place(v[1]), in.place(v[2]), in.turn(v[3]), in.number(v[4], kMostRoll), in.number(v[5], kMostRoll)});
        });
        in.lines(line, "goals", 6, [&](const Json& v) {
            EndpointGoal goal;
            const EndpointRef end{in.id(v[0]), in.flag(v[1])};
            goal.pinned = in.flag(v[2]);
            goal.target = goal.from = in.place(v[3]);
            if (!v[4].is_null()) goal.roll = in.number(v[4], kMostRoll);
            if (!v[5].is_null()) goal.rotation = numbers(in.turn(v[5]));
            pose.goals.insert_or_assign(end, goal);
        });
        in.lines(line, "handles", 6, [&](const Json& v) {
            HandleGoal goal;
            const FaceRef handle{in.id(v[0]), in.word(v[1])};
            goal.pinned = in.flag(v[2]);
            goal.target.held = in.flag(v[3]);
            goal.target.at = in.place(v[4]);
            goal.target.rotation = in.turn(v[5]);
            goal.from = goal.target;
            pose.handles.insert_or_assign(handle, goal);
        });
        in.lines(line, "turns", 4, [&](const Json& v) {
            pose.turns.insert_or_assign(PartRef{in.id(v[0]), ModelPart{in.whole(v[1]), in.whole(v[2])}}, in.turn(v[3]));
        });
        in.lines(line, "morphs", 3, [&](const Json& v) { pose.morphs.insert_or_assign(MorphRef{in.id(v[0]), in.whole(v[1])}, in.number(v[2], 1e6)); });
        if (!in.good || pose.name.empty()) return broken();
        poses.push_back(std::move(pose));
    }
    return poses;
}

}  // namespace imomushi
