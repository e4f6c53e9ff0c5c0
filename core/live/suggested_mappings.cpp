// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/suggested_mappings.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/document/avatar.h"
#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "core/document/rig_follower.h"
#include "core/input/pose_numbers.h"
#include "core/input/voice_analyser.h"
#include "core/mesh/avatar.h"
#include "core/mesh/bounds.h"
#include "core/mesh/humanoid.h"
#include "core/mesh/render_model.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

/// usualReach() over characterSize().
constexpr double kReach = 0.15;
/// Bones within this part of the size belong to one hand.
constexpr double kHand = 0.085;
/// What reaches less far to a side than this part of the size is in the middle.
constexpr double kSide = 0.055;
/// Who performs looks from the front (+z): of two limbs as far out or as high, the nearer one is led first.
constexpr double kFront = 0.25;
/// Cutoffs of smoothing, Hz: a key jumps from 0 to 1 and needs more than a stick, which a hand leads.
constexpr double kKeyHertz = 1.0, kStickHertz = 8.0, kPoseHertz = 2.0;

/// Speed of a cycle at the end of its control.
constexpr double kFastCycle = 3.0;

/// What is led by a stick: the free end of a limb, or a handle.
struct Limb {
    Vec3 at = Vec3::Zero();  ///< at rest, m, world
    std::string target;      ///< before "/x"
    int bone = -1;           ///< of the skeleton, the last one; -1: a handle
};

struct Limbs {
    std::vector<Limb> all;
    double size = 0.0;  ///< m, characterSize()
    std::vector<int> parent;  ///< of each bone
};

Limbs limbsOf(const Document& document, const CharacterPlan& plan) {
    const Skeleton& skeleton = plan.input.skeleton;
    const auto bones = static_cast<int>(skeleton.bones.size());
    Limbs limbs;
    limbs.parent = boneTree(skeleton).parent;
    limbs.size = characterSize(document);

    // A bone is a leaf where no other one hangs on it. `reach`: how far what hangs on a bone goes from its start.
    const auto of = [](const auto& list, int i) -> decltype(auto) { return list[static_cast<std::size_t>(i)]; };
    std::vector<int> leaves(skeleton.bones.size(), 0);
    std::vector<double> reach(skeleton.bones.size(), 0.0);
    std::vector<char> hasChild(skeleton.bones.size());
    for (int b = 0; b < bones; ++b)
        if (of(limbs.parent, b) >= 0) hasChild[static_cast<std::size_t>(of(limbs.parent, b))] = 1;
    for (int b = bones - 1; b >= 0; --b) {
        if (!of(hasChild, b)) leaves[static_cast<std::size_t>(b)] = 1;
        for (int up = b; up >= 0; up = of(limbs.parent, up))
            reach[static_cast<std::size_t>(up)] = std::max(of(reach, up), (of(skeleton.points, of(skeleton.bones, b).end) - of(skeleton.points, of(skeleton.bones, up).start)).norm());
        if (const int up = of(limbs.parent, b); up >= 0) leaves[static_cast<std::size_t>(up)] += of(leaves, b);
    }
    std::set<int> taken, used, starts;
    for (const auto& [end, held] : document.goals)
        if (held.pinned) used.insert(plan.pointIndex(end));
    for (int b = 0; b < bones; ++b) starts.insert(of(skeleton.bones, b).start);
    for (int b = 0; b < bones; ++b) {
        if (of(hasChild, b)) continue;
        int hand = b;
        for (int up = of(limbs.parent, b); up >= 0 && of(reach, up) < kHand * limbs.size; up = of(limbs.parent, up))
            if (of(leaves, up) > 1) hand = up;
        const int point = of(skeleton.bones, hand).end;
        // What ends where other bones begin is in the middle of the character, not at the end of a limb.
        if (used.contains(point) || (hand == b && starts.contains(point)) || !taken.insert(point).second) continue;
        limbs.all.push_back({of(skeleton.points, point), "bone/" + document.bones.at(of(plan.bones, hand))->name + "/end", hand});
    }
    if (limbs.all.empty())
        for (const FaceRef& handle : plan.handles) {
            const auto& list = document.elements.at(handle.element)->handles;
            const auto found = std::find_if(list.begin(), list.end(), [&](const Handle& h) { return h.face == handle.face; });
            if (found != list.end()) limbs.all.push_back({found->point, "handle/" + handle.face, -1});
        }
    return limbs;
}

/// Left of the scene, right of the scene, and the rest by height; none is there twice.
struct Led {
    std::vector<Limb> sides, rest;
};
Led ledBy(const Limbs& limbs) {
    Led led;
    std::vector<Limb> left = limbs.all;
    if (left.empty()) return led;
    double middle = 0.0;
    for (const Limb& limb : left) middle += limb.at.x() / static_cast<double>(left.size());
    for (const double side : {-1.0, 1.0}) {
        const auto best = std::max_element(left.begin(), left.end(), [&](const Limb& a, const Limb& b) { return side * a.at.x() + kFront * a.at.z() < side * b.at.x() + kFront * b.at.z(); });
        if (best == left.end() || side * (best->at.x() - middle) < kSide * limbs.size) continue;
        led.sides.push_back(*best);
        left.erase(best);
    }
    std::stable_sort(left.begin(), left.end(), [](const Limb& a, const Limb& b) { return a.at.y() + kFront * a.at.z() > b.at.y() + kFront * b.at.z(); });
    led.rest = std::move(left);
    while (led.sides.size() < 2 && !led.rest.empty()) {
        led.sides.push_back(led.rest.front());
        led.rest.erase(led.rest.begin());
    }
    return led;
}

class Suggestion {
public:
    Suggestion(const Document& document, std::string source) : document_(document), source_(std::move(source)) {}

    void add(std::string_view channel, int component, const std::string& target, double inLow, double outLow, double outHigh, double hertz, double inHigh = 1.0) {
        InputMapping made;
        made.row.source = source_;
        made.row.channel = channel;
        made.row.component = component;
        made.row.curve.inLow = inLow;
        made.row.curve.inHigh = inHigh;
        made.row.curve.outLow = outLow;
        made.row.curve.outHigh = outHigh;
        made.row.filter.hertz = hertz;
        made.target = target;
        const bool known = std::ranges::any_of(made_, [&](const InputMapping& m) { return m.sameLine(made); });
        if (!known && mappedTarget(document_, target)) made_.push_back(std::move(made));
    }
    [[nodiscard]] const std::string& source() const { return source_; }
    [[nodiscard]] InputMappings taken() { return std::move(made_); }

private:
    const Document& document_;
    std::string source_;
    InputMappings made_;
};

struct Stick {
    std::string_view x, y;
    int xNumber = 0, yNumber = 0;
};
/// How a device leads a character.
struct Controls {
    std::vector<Stick> sticks;
    std::array<std::string_view, 2> forward;
    std::array<std::string_view, 4> shows;
    std::string_view letGo;
    double hertz = 0.0;
    /// How much there is of the first cycle, and how fast it runs; empty: the device has nothing that goes a part of its way. Where there are cycles, buttons bring limbs forward in their place.
    std::array<std::string_view, 2> cycle, forwardButtons;
};
Controls controlsOf(InputProtocol protocol) {
    if (protocol == InputProtocol::Pad) return {{{"left-x", "left-y"}, {"right-x", "right-y"}}, {"left-trigger", "right-trigger"}, {"a", "b", "x", "y"}, "back", kStickHertz, {"left-trigger", "right-trigger"}, {"left-shoulder", "right-shoulder"}};
    return {{{"wasd", "wasd", 0, 1}, {"arrows", "arrows", 0, 1}, {"ijkl", "ijkl", 0, 1}}, {"q", "e"}, {"1", "2", "3", "4"}, "backspace", kKeyHertz, {}, {}};
}

void suggestControls(Suggestion& made, const Document& document, const Limbs& limbs, InputProtocol protocol) {
    const Controls controls = controlsOf(protocol);
    const Led led = ledBy(limbs);
    const double reach = usualReach(document);
    const bool cycles = !controls.cycle[0].empty() && !cyclesOf(document).empty();
    std::vector<Limb> order = led.sides;
    order.insert(order.end(), led.rest.begin(), led.rest.end());
    for (std::size_t i = 0; i < std::min(order.size(), controls.sticks.size()); ++i) {
        const Stick& stick = controls.sticks[i];
        made.add(stick.x, stick.xNumber, order[i].target + "/x", -1.0, -reach, reach, controls.hertz);
        made.add(stick.y, stick.yNumber, order[i].target + "/y", -1.0, -reach, reach, controls.hertz);
        if (i < controls.forward.size()) made.add(cycles ? controls.forwardButtons[i] : controls.forward[i], 0, order[i].target + "/z", 0.0, 0.0, reach, cycles ? kKeyHertz : controls.hertz);
    }
    if (cycles) {
        const std::string of = "cycle/" + cyclesOf(document).front().name;
        made.add(controls.cycle[0], 0, of + "/amount", 0.0, 0.0, 1.0, controls.hertz);
        made.add(controls.cycle[1], 0, of + "/speed", 0.0, 1.0, kFastCycle, controls.hertz);
    }
    std::vector<std::string> shows;
    for (const KeptPose& pose : keptPoses(document))
        if (cyclesThrough(document, pose.name).empty()) shows.push_back("pose/" + pose.name + "/weight");
    for (const auto& [id, character] : document.characters)
        for (std::size_t m = 0; m < character->model->morphs.size() && shows.size() < controls.shows.size(); ++m) shows.push_back("morph/" + character->name + "/" + character->model->morphs[m].name);
    for (std::size_t i = 0; i < std::min(shows.size(), controls.shows.size()); ++i) made.add(controls.shows[i], 0, shows[i], 0.0, 0.0, 1.0, kPoseHertz);
    made.add(controls.letGo, 0, "trigger/let-go", 0.0, 0.0, 1.0, 0.0);
}

// ---- VMC

bool isHuman(const std::map<std::string, std::string>& roles) { return roles.contains("head") && (roles.contains("leftUpperArm") || roles.contains("leftUpperLeg")); }

void addTurns(Suggestion& made, const std::string& bone, const std::string& turned) {
    for (int axis = 0; axis < 3; ++axis)
        made.add("bone/" + bone, kPoseTurn + axis, "bone/" + turned + "/turn-" + "xyz"[axis], -std::numbers::pi, -std::numbers::pi, std::numbers::pi, 0.0, std::numbers::pi);
}

void suggestBody(Suggestion& made, const Document& document, const CharacterPlan& plan, const Limbs& limbs) {
    const auto roles = bonesByRole(document, plan);
    if (isHuman(roles)) {
        for (const HumanRole& role : kHumanRoles)
            if (const auto bone = roles.find(std::string(role.name)); bone != roles.end()) addTurns(made, vmcBoneName(bone->first), bone->second);
        return;
    }
    // The sides of who performs are those of the character: its left is +x.
    Led led = ledBy(limbs);
    const auto nameOf = [&](int bone) { return document.bones.at(plan.bones[static_cast<std::size_t>(bone)])->name; };
    // From where a limb leaves the others to its end: three bones of it, the first, one in the middle and the last.
    std::vector<int> children(limbs.parent.size(), 0);
    for (const int parent : limbs.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    const auto chainOf = [&](const Limb& limb) {
        std::vector<int> chain{limb.bone};
        for (int up = limbs.parent[static_cast<std::size_t>(limb.bone)]; up >= 0 && children[static_cast<std::size_t>(up)] == 1; up = limbs.parent[static_cast<std::size_t>(up)]) chain.insert(chain.begin(), up);
        return chain;
    };
    if (limbs.all.empty() || limbs.all.front().bone < 0) return;
    const bool sided = led.sides.size() == 2 && led.sides[1].at.x() - led.sides[0].at.x() > kSide * limbs.size;
    if (sided)
        for (const auto& [side, limb] : {std::pair(std::string("Right"), led.sides[0]), std::pair(std::string("Left"), led.sides[1])}) {
            const std::vector<int> chain = chainOf(limb);
            addTurns(made, side + "UpperArm", nameOf(chain.front()));
            if (chain.size() > 2) addTurns(made, side + "LowerArm", nameOf(chain[chain.size() / 2]));
            if (chain.size() > 1) addTurns(made, side + "Hand", nameOf(chain.back()));
        }
    const std::vector<Limb>& others = sided ? led.rest : limbs.all;
    if (!others.empty()) addTurns(made, "Head", nameOf(others.front().bone));
}

/// What senders of VRM 0 call the expressions of VRM 1.0.
constexpr std::pair<std::string_view, std::string_view> kOlderNames[] = {{"aa", "A"}, {"ih", "I"}, {"ou", "U"}, {"ee", "E"}, {"oh", "O"}, {"happy", "Joy"}, {"angry", "Angry"}, {"sad", "Sorrow"},
                                                                        {"relaxed", "Fun"}, {"blink", "Blink"}, {"blinkLeft", "Blink_L"}, {"blinkRight", "Blink_R"}};

void suggestFace(Suggestion& made, const CharacterSource& character) {
    // A target takes the expression that moves it most: two that drive one number would stand in each other's way.
    std::map<std::string, std::pair<double, std::string>> expressionOf;
    if (character.rig)
        for (const AvatarExpression& expression : avatarFacts(*character.rig).expressions)
            for (const auto& [target, amount] : expression.morphs)
                if (auto& known = expressionOf[target]; amount > known.first) known = {amount, expression.name};
    for (const MorphTarget& morph : character.model->morphs) {
        const std::string target = "morph/" + character.name + "/" + morph.name;
        const auto expression = expressionOf.find(morph.name);
        if (expression == expressionOf.end()) {
            made.add("blend/" + morph.name, 0, target, 0.0, 0.0, 1.0, 0.0);
            continue;
        }
        const auto& [amount, name] = expression->second;
        made.add("blend/" + name, 0, target, 0.0, 0.0, amount, 0.0);
        if (const std::string older = olderExpressionName(name); older != name) made.add("blend/" + older, 0, target, 0.0, 0.0, amount, 0.0);
    }
}

// ---- a microphone

/// Shapes of the mouth show expressions and morph targets of their names. Where there are none, loudness opens a mouth that has another name, or else lifts the highest limb: it speaks with that.
void suggestVoice(Suggestion& made, const Document& document, const Limbs& limbs) {
    constexpr double kMouthHertz = 6.0, kNod = 0.25;  // of usualReach()
    constexpr double kLoud = 0.8;                     // speech is seldom as loud as it gets
    std::optional<std::string> mouth;
    bool shaped = false;
    for (const auto& [id, character] : document.characters) {
        const auto expressions = character->rig ? avatarFacts(*character->rig).expressions : std::vector<AvatarExpression>();
        std::set<std::string> taken;  // of vowels that share a shape the first one moves it
        for (const std::string_view vowel : std::span(kVoiceChannels).subspan(1)) {
            const std::string of = "morph/" + character->name + "/";
            const auto show = [&](const std::string& target, double amount) {
                if (!taken.insert(target).second) return;
                made.add(vowel, 0, of + target, 0.0, 0.0, amount, kMouthHertz, kLoud);
                shaped = true;
            };
            const auto known = std::ranges::find(expressions, vowel, &AvatarExpression::name);
            if (known != expressions.end())
                for (const auto& [target, amount] : known->morphs) show(target, amount);
            else if (character->model->morphIndex(std::string(vowel)) >= 0) show(std::string(vowel), 1.0);
        }
        for (const MorphTarget& morph : character->model->morphs) {
            std::string name = morph.name;
            std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
            if (!mouth && (name.find("jaw") != std::string::npos || name.find("mouth") != std::string::npos || name.find("talk") != std::string::npos)) mouth = "morph/" + character->name + "/" + morph.name;
        }
    }
    if (shaped) return;
    if (mouth) return made.add("level", 0, *mouth, 0.0, 0.0, 1.0, kMouthHertz, kLoud);
    // One that nothing else moves, if there is one.
    std::vector<Limb> free = limbs.all;
    if (document.mappings) std::erase_if(free, [&](const Limb& limb) { return std::ranges::any_of(*document.mappings, [&](const InputMapping& m) { return m.row.source != made.source() && m.target.starts_with(limb.target + "/"); }); });
    if (free.empty()) free = limbs.all;
    const auto highest = std::ranges::max_element(free, {}, [](const Limb& limb) { return limb.at.y(); });
    if (highest != free.end()) made.add("level", 0, highest->target + "/y", 0.0, 0.0, kNod * usualReach(document), kMouthHertz, kLoud);
}

}  // namespace

std::map<std::string, std::string> bonesByRole(const Document& document, const CharacterPlan& plan) {
    const auto nameOf = [&](std::size_t bone) { return document.bones.at(plan.bones[bone])->name; };
    for (const auto& [id, character] : document.characters) {
        if (!character->rig || character->rig->bones.empty()) continue;
        std::map<std::string, std::string> found;
        const RigFollower follower(document, plan, *character);
        for (const RigRole& role : humanRoles(*character->rig))
            for (std::size_t b = 0; b < follower.follows().size(); ++b)
                // The first bone that follows it, but for one that has its very name.
                if (follower.follows()[b] == role.bone && (!found.contains(role.role) || nameOf(b) == character->rig->bones[static_cast<std::size_t>(role.bone)].name)) found[role.role] = nameOf(b);
        if (isHuman(found)) return found;
    }
    // Bones that were placed by hand and have names that tell.
    Rig rig;
    const std::vector<int> parent = boneTree(plan.input.skeleton).parent;
    for (std::size_t b = 0; b < plan.bones.size(); ++b) {
        RigBone bone;
        bone.name = nameOf(b);
        if (const auto word = bone.name.find("-bone"); word != std::string::npos) bone.name.erase(word, 5);
        bone.parent = parent[b];
        bone.head = plan.input.skeleton.points[static_cast<std::size_t>(plan.input.skeleton.bones[b].start)];
        bone.tail = plan.input.skeleton.points[static_cast<std::size_t>(plan.input.skeleton.bones[b].end)];
        rig.bones.push_back(std::move(bone));
    }
    std::map<std::string, std::string> found;
    for (const RigRole& role : humanRoles(rig)) found.emplace(role.role, nameOf(static_cast<std::size_t>(role.bone)));
    return found;
}

std::string vmcBoneName(std::string role) {
    for (const auto& [ours, unity] : {std::pair<std::string_view, std::string_view>{"ThumbProximal", "ThumbIntermediate"}, {"ThumbMetacarpal", "ThumbProximal"}})
        if (role.ends_with(ours)) {
            role.replace(role.size() - ours.size(), ours.size(), unity);
            break;
        }
    if (!role.empty()) role[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(role[0])));
    return role;
}

std::string olderExpressionName(std::string_view name) {
    for (const auto& [now, older] : kOlderNames)
        if (now == name) return std::string(older);
    return std::string(name);
}

double characterSize(const Document& document) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& [id, element] : document.elements) {
        const Points& vertices = element->mesh->body.vertices;
        if (vertices.rows() == 0) continue;
        const Bounds box = boundsOf(vertices);
        low = low.cwiseMin(box.low);
        high = high.cwiseMax(box.high);
    }
    return low.x() <= high.x() ? (high - low).norm() : 1.0;
}

double usualReach(const Document& document) {
    const double reach = kReach * characterSize(document), unit = std::pow(10.0, std::floor(std::log10(std::max(reach, 1e-9))) - 1.0);
    return unit * std::round(reach / unit);
}

InputMappings suggestedMappings(const Document& document, const CharacterPlan& plan, InputProtocol protocol, const std::string& source) {
    Suggestion made(document, source);
    const Limbs limbs = limbsOf(document, plan);
    if (protocol == InputProtocol::Pad || protocol == InputProtocol::Keys) suggestControls(made, document, limbs, protocol);
    if (protocol == InputProtocol::Voice) suggestVoice(made, document, limbs);
    if (protocol == InputProtocol::Vmc) {
        suggestBody(made, document, plan, limbs);
        for (const auto& [id, character] : document.characters) suggestFace(made, *character);
    }
    return made.taken();
}

}  // namespace imomushi
