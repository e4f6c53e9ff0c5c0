// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include "core/base/finite.h"
#include "core/commands/core_commands.h"
#include "core/commands/handle_commands.h"
#include "core/commands/meetings.h"
#include "core/document/command_support.h"
#include "core/document/input_mapping.h"
#include "core/document/morph_weights.h"
#include "core/live/live_input.h"
#include "core/session/document_edit.h"
#include "core/session/session_access.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

namespace {

constexpr double kLongestGlide = 1e6;       // s
constexpr double kLargestRoll = 1e6;        // radians
constexpr double kLongestFrame = 10.0;      // s
constexpr int kMaxFrames = 10'000'000;     // two days of 60 Hz

Json texts(const std::vector<std::string>& list) {
    Json array = Json::array();
    for (const std::string& text : list) array.push_back(text);
    return array;
}

/// What is held at the joint point of `end`: an endpoint of another bone may be the same point.
std::map<EndpointRef, EndpointGoal>::iterator heldAt(Document& document, const CharacterPlan& plan, const EndpointRef& end) {
    const int point = plan.pointIndex(end);
    return std::find_if(document.goals.begin(), document.goals.end(), [&](const auto& held) { return plan.pointIndex(held.first) == point; });
}

/// The endpoint that a command names, and the character that shows it.
struct ShownEndpoint {
    EndpointRef end;
    const CharacterPlan& plan;
};
Result<ShownEndpoint> endpointOf(const DocumentEdit& edit, const Json& arguments) {
    IMOMUSHI_TRY(const auto end, edit.document.endpoint(text(arguments, "endpoint")));
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    return ShownEndpoint{end, *plan};
}

Result<Json> pin(DocumentEdit& edit, const Json& arguments, const Progress&) {
    if (const auto handle = edit.document.handle(text(arguments, "endpoint"))) return pinHandle(edit, *handle);
    IMOMUSHI_TRY(const auto shown, endpointOf(edit, arguments));
    IMOMUSHI_TRY(const auto position, edit.positionOf(shown.end));
    auto held = heldAt(edit.document, shown.plan, shown.end);
    if (held == edit.document.goals.end()) {
        EndpointGoal made;
        made.target = position;
        held = edit.document.goals.emplace(shown.end, made).first;
    }
    held->second.pinned = true;
    if (const Json* orientation = find(arguments, "orientation")) {
        if (orientation->get<bool>() && held->first != shown.end) {  // it is held by a bone that meets this one
            auto taken = edit.document.goals.extract(held);
            taken.key() = shown.end;
            held = edit.document.goals.insert(std::move(taken)).position;
        }
        held->second.rotation.reset();
        const auto bone = static_cast<std::size_t>(shown.plan.boneIndex(held->first.bone));
        const auto& frames = edit.document.pose.frames;
        const Eigen::Quaterniond turn = bone < frames.size() ? frames[bone] : Eigen::Quaterniond::Identity();
        if (orientation->get<bool>()) held->second.rotation = std::array{turn.x(), turn.y(), turn.z(), turn.w()};
    }
    return Json::object();
}

Result<Json> unpin(DocumentEdit& edit, const Json& arguments, const Progress&) {
    if (const auto handle = edit.document.handle(text(arguments, "endpoint"))) return unpinHandle(edit, *handle);
    IMOMUSHI_TRY(const auto shown, endpointOf(edit, arguments));
    const auto held = heldAt(edit.document, shown.plan, shown.end);
    if (held == edit.document.goals.end() || !held->second.pinned)
        return fail("not-pinned", "The endpoint \"" + text(arguments, "endpoint") + "\" is not pinned.");
    edit.document.goals.erase(held);
    return Json::object();
}

Result<Json> drag(DocumentEdit& edit, const Json& arguments, const Progress&) {
    if (const auto handle = edit.document.handle(text(arguments, "endpoint"))) return dragHandle(edit, *handle, arguments);
    if (arguments.contains("rotation")) return fail("unknown-key", "\"rotation\" goes with handles; the end of a bone is turned by \"roll\".");
    IMOMUSHI_TRY(const auto shown, endpointOf(edit, arguments));
    IMOMUSHI_TRY(const auto position, edit.positionOf(shown.end));
    EndpointGoal made;
    made.target = *vector3(arguments.at("to"));
    if (auto ok = readNumber(arguments, "roll", -kLargestRoll, kLargestRoll, made.roll); !ok) return tl::unexpected(ok.error());
    if (auto ok = readNumber(arguments, "seconds", 0.0, kLongestGlide, made.seconds); !ok) return tl::unexpected(ok.error());
    made.from = position;
    Document& document = edit.document;
    if (!document.pose.roll.empty()) made.fromRoll = document.pose.roll[static_cast<std::size_t>(shown.plan.pointIndex(shown.end))];
    if (const auto held = heldAt(document, shown.plan, shown.end); held != document.goals.end()) {
        made.pinned = held->second.pinned;
        if (!made.roll) made.roll = held->second.roll;
        if (held->second.rotation) {  // its bone keeps its direction, and the goal its place
            made.rotation = held->second.rotation;
            held->second = made;
            return Json::object();
        }
        document.goals.erase(held);
    }
    document.goals.insert_or_assign(shown.end, made);
    return Json::object();
}

Result<Json> showDrag(LiveCharacter& live, const Json& arguments, Json) {
    const Document& document = live.document();
    if (const auto handle = document.handle(text(arguments, "endpoint"))) return showHandle(live, *handle);
    const EndpointRef end = *document.endpoint(text(arguments, "endpoint"));
    const int point = live.plan().pointIndex(end);
    const EndpointGoal held = std::find_if(document.goals.begin(), document.goals.end(), [&](const auto& goal) { return live.plan().pointIndex(goal.first) == point; })->second;
    live.hidePositions();
    if (held.seconds > 0.0) return Json{{"seconds", held.seconds}, {"warnings", texts(live.warningTexts(0))}};
    // With bone dynamics the body follows as frames pass.
    if (document.effects.has(EffectKind::BoneDynamics))
        return Json{{"distance", (held.from - held.target).norm()}, {"position", json(held.from)}, {"settled", false}, {"warnings", texts(live.warningTexts(0))}};

    IMOMUSHI_TRY(const auto solved, live.converge());
    IMOMUSHI_TRY(const auto now, live.positionOf(end));
    Json answer{{"distance", (now - held.target).norm()}, {"position", json(now)}, {"settled", solved.converged},
                {"iterations", solved.iterations}, {"ms", solved.milliseconds},
                {"warnings", texts(live.warningTexts(solved.warnings))}};
    return answer;
}

Result<Json> release(DocumentEdit& edit, const Json& arguments, const Progress&) {
    auto& all = edit.document.goals;
    int released = 0;
    const auto let = [&](std::map<EndpointRef, EndpointGoal>::iterator held) -> Result<std::map<EndpointRef, EndpointGoal>::iterator> {
        ++released;
        if (!held->second.pinned) return all.erase(held);
        // A pin that was dragged stays a pin, where it is now.
        IMOMUSHI_TRY(const auto position, edit.positionOf(held->first));
        EndpointGoal pinned;
        pinned.pinned = true;
        pinned.target = position;
        pinned.rotation = held->second.rotation;
        held->second = pinned;
        return std::next(held);
    };
    if (arguments.contains("endpoint")) {
        if (const auto handle = edit.document.handle(text(arguments, "endpoint"))) {
            IMOMUSHI_TRY(const auto wasHeld, releaseHandle(edit, *handle));
            if (!wasHeld) return fail("not-held", "The handle \"" + handle->face + "\" is not held.");
            return Json{{"released", 1}};
        }
        IMOMUSHI_TRY(const auto shown, endpointOf(edit, arguments));
        const auto held = heldAt(edit.document, shown.plan, shown.end);
        if (held == all.end()) return fail("not-held", "The endpoint \"" + text(arguments, "endpoint") + "\" is not held.");
        if (auto done = let(held); !done) return tl::unexpected(done.error());
    } else {
        for (auto held = all.begin(); held != all.end();) {
            IMOMUSHI_TRY(held, let(held));
        }
        for (const auto& [handle, goal] : std::map(edit.document.handleGoals)) {
            IMOMUSHI_TRY(const auto wasHeld, releaseHandle(edit, handle));
            released += wasHeld;
        }
    }
    return Json{{"released", released}};
}

Result<Json> showRelease(LiveCharacter& live, const Json&, Json answer) {
    if (answer["released"] > 0 && live.document().effects.has(EffectKind::BoneDynamics))
        if (auto ok = live.returnToRest(); !ok) return tl::unexpected(ok.error());
    return answer;
}

Result<Json> rest(DocumentEdit& edit, const Json&, const Progress&) {
    IMOMUSHI_TRY(const auto plan, edit.shownPlan());
    Document& document = edit.document;
    document.pose = {};
    document.touches.clear();
    document.turns.clear();
    document.morphs.clear();
    restHandles(document);
    std::erase_if(document.goals, [](const auto& held) { return !held.second.pinned; });
    for (auto& [end, held] : document.goals) {
        const bool turned = held.rotation.has_value();
        held = {};
        held.pinned = true;
        if (turned) held.rotation = std::array{0.0, 0.0, 0.0, 1.0};
        held.target = plan->input.skeleton.points[static_cast<std::size_t>(plan->pointIndex(end))];
    }
    return Json::object();
}

Result<Json> showRest(LiveCharacter& live, const Json&, Json answer) {
    live.hidePositions();
    live.jumpToPose();
    return answer;
}

Result<Json> putFinger(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto element, elementOf(edit.document, text(arguments, "element")));
    const PartId id = element->id;
    const Vec3 point = *vector3(arguments.at("point"));
    const Json& to = arguments.at("to");
    const auto target = to.is_null() ? std::optional(Vec3(Vec3::Zero())) : vector3(to);
    if (!target) return fail("bad-type", "\"to\" must be three numbers [x,y,z], or null to lift the finger.");
    double radius = 0.0;
    if (auto ok = readNumber(arguments, "radius", 0.0, kMaxCoordinate, radius); !ok) return tl::unexpected(ok.error());
    auto& touches = edit.document.touches;
    const auto known = std::find_if(touches.begin(), touches.end(), [&](const Touch& t) { return t.element == id && t.point == point; });
    if (to.is_null()) {
        if (known == touches.end()) return fail("not-touched", "No finger is at that point of \"" + element->name + "\": lift it by the point where it was put down.");
        const int finger = known->finger;
        touches.erase(known);
        if (auto plan = edit.shownPlan(); !plan) return tl::unexpected(plan.error());
        return Json{{"finger", finger}};
    }
    if (!edit.document.effects.has(EffectKind::Touch, id))
        return fail("not-enabled", "Fingers need the effect \"touch\" on \"" + element->name + "\": enable it, and precompute.");
    if (auto plan = edit.shownPlan(); !plan) return tl::unexpected(plan.error());
    const auto response = edit.responses().fittingOf(id);
    if (!response || response->touch.columns() == 0)
        return fail("not-precomputed", "\"" + element->name + "\" is not precomputed for fingers: precompute it (it needs a joint face that holds it).");
    Touch made{id, 0, point, *target, radius};
    if (known != touches.end()) {
        made.finger = known->finger;
        *known = made;
    } else {
        const auto taken = [&](int finger) {
            return std::any_of(touches.begin(), touches.end(), [&](const Touch& t) { return t.element == id && t.finger == finger; });
        };
        while (made.finger < TouchContact::kFingers && taken(made.finger)) ++made.finger;
        if (made.finger == TouchContact::kFingers)
            return fail("too-many-fingers", "\"" + element->name + "\" has " + std::to_string(TouchContact::kFingers) + " fingers already: lift one.");
        touches.push_back(made);
    }
    return Json{{"finger", made.finger}};
}

Result<Json> showTouch(LiveCharacter& live, const Json& arguments, Json answer) {
    if (arguments.at("to").is_null()) return answer;
    const Vec3 point = *vector3(arguments.at("point"));
    const Document& document = live.document();
    const PartId element = document.elementNamed(text(arguments, "element"))->id;
    const auto put = std::find_if(document.touches.begin(), document.touches.end(), [&](const Touch& t) { return t.element == element && t.point == point; });
    if (!live.putFinger(*put))
        return fail("not-touchable", "That point of \"" + text(arguments, "element") + "\" cannot be touched: choose one of its free surface.");
    return answer;
}

bool isFinite(const Character& character, const Pose& pose, std::size_t elements) {
    for (const Vec3& p : pose.points)
        if (!allFinite(p)) return false;
    for (std::size_t e = 0; e < elements; ++e) {
        const auto surface = character.surface(static_cast<int>(e));
        for (int i = 0; i < 3 * surface.vertices; ++i)
            if (!std::isfinite(surface.positions[i]) || !std::isfinite(surface.normals[i])) return false;
    }
    return true;
}

/// What a hand or a device gives before a frame.
struct StepInput {
    int frame = 0;
    LiveInput input;
};

/// "inputs" of the command "step", in the order of their frames. Errors: "bad-type", "bad-value", "unknown-key", "not-held", and those of names.
Result<std::vector<StepInput>> stepInputs(const Json& list, int frames, const Document& document, const CharacterPlan& plan) {
    std::vector<StepInput> inputs;
    for (const Json& given : list) {
        if (!given.is_object()) return fail("bad-type", "An input is an object: {\"frame\":0,\"endpoint\":\"bone/end\",\"to\":[x,y,z]}.");
        StepInput made;
        const bool isMorph = given.contains("morph"), isEffect = given.contains("effect");
        const std::initializer_list<std::string_view> ofEffect = {"frame", "effect", "property", "axis", "value"}, ofMorph = {"frame", "character", "morph", "weight"}, ofPlace = {"frame", "endpoint", "to", "roll", "rotation"};
        const auto& known = isEffect ? ofEffect : isMorph ? ofMorph : ofPlace;
        for (const auto& [key, value] : given.items())
            if (std::find(known.begin(), known.end(), key) == known.end()) return fail("unknown-key", "An input has no \"" + key + "\".");
        if (isMorph && !(given.contains("frame") && given.contains("weight") && given["morph"].is_string() && given.contains("character") && given["character"].is_string()))
            return fail("bad-type", "An input of a morph target needs \"frame\", \"character\", \"morph\" and \"weight\".");
        if (isEffect && !(given.contains("frame") && given.contains("value") && given["effect"].is_string() && given.contains("property") && given["property"].is_string()))
            return fail("bad-type", "An input of an effect needs \"frame\", \"effect\", \"property\" and \"value\".");
        if (!isMorph && !isEffect && !(given.contains("frame") && given.contains("to") && given.contains("endpoint") && given["endpoint"].is_string()))
            return fail("bad-type", "An input needs \"frame\", \"endpoint\" and \"to\".");
        IMOMUSHI_TRY(const auto frame, numberWithin(given["frame"], "frame", 0, frames - 1));
        made.frame = static_cast<int>(frame);
        if (!inputs.empty() && made.frame < inputs.back().frame) return fail("bad-value", "Inputs come in the order of their frames.");
        if (isEffect) {
            double axis = 0.0;
            if (auto ok = readNumber(given, "axis", 0, 2, axis); !ok) return tl::unexpected(ok.error());
            const std::string target = "effect/" + text(given, "effect") + "/" + text(given, "property") + (given.contains("axis") ? std::string("/") + "xyz"[static_cast<int>(axis)] : "");
            IMOMUSHI_TRY(const auto driven, mappedTarget(document, target));
            made.input.kind = LiveInput::Kind::Effect;
            made.input.effect = driven.effect;
            made.input.value = driven.value;
            const EffectProperty& property = propertyOf(made.input).first;
            IMOMUSHI_TRY(made.input.weight, numberWithin(given["value"], "value", property.low, property.high));
            inputs.push_back(made);
            continue;
        }
        if (isMorph) {
            made.input.kind = LiveInput::Kind::Morph;
            IMOMUSHI_TRY(made.input.morph, morphOf(document, text(given, "character"), text(given, "morph")));
            IMOMUSHI_TRY(made.input.weight, numberWithin(given["weight"], "weight", -kLargestMorphWeight, kLargestMorphWeight));
            inputs.push_back(made);
            continue;
        }
        const auto to = vector3(given["to"]);
        if (!to) return fail("bad-type", "\"to\" of an input must be three numbers [x,y,z].");
        made.input.target = *to;
        const std::string name = given["endpoint"].get<std::string>();
        if (const auto handle = document.handle(name)) {
            if (given.contains("roll")) return fail("unknown-key", "\"roll\" goes with ends of bones; a handle is turned by \"rotation\".");
            made.input.kind = LiveInput::Kind::Handle;
            made.input.handle = plan.handleIndex(*handle);
            const auto held = document.handleGoals.find(*handle);
            if (held == document.handleGoals.end() || !held->second.target.held) return fail("not-held", "The handle \"" + name + "\" is not held: drag it before an input moves it.");
            made.input.rotation = held->second.target.rotation;
            if (given.contains("rotation")) {
                IMOMUSHI_TRY(made.input.rotation, rotationFrom(given["rotation"], "rotation"));
            }
        } else {
            if (given.contains("rotation")) return fail("unknown-key", "\"rotation\" goes with handles; the end of a bone is turned by \"roll\".");
            IMOMUSHI_TRY(made.input.end, document.endpoint(name));
            const int point = plan.pointIndex(made.input.end);
            if (std::none_of(document.goals.begin(), document.goals.end(), [&](const auto& held) { return plan.pointIndex(held.first) == point; }))
                return fail("not-held", "The endpoint \"" + name + "\" is not held: drag it before an input moves it.");
            std::optional<double> roll;
            if (auto ok = readNumber(given, "roll", -kLargestRoll, kLargestRoll, roll); !ok) return tl::unexpected(ok.error());
            made.input.hasRoll = roll.has_value();
            made.input.roll = roll.value_or(0.0);
        }
        inputs.push_back(made);
    }
    return inputs;
}

Result<Json> step(SessionAccess& access, const Json& arguments, const Progress& progress) {
    LiveCharacter& live = access.live;
    const Document& document = access.document();
    IMOMUSHI_TRY(const auto frames, numberWithin(arguments.at("frames"), "frames", 1, kMaxFrames));
    const int count = static_cast<int>(frames);
    std::vector<double> times = {1.0 / 60.0};
    if (const Json* given = find(arguments, "dt")) {
        if (given->is_array() && given->size() != static_cast<std::size_t>(count)) return fail("bad-value", "\"dt\" must have a number for each frame.");
        times.clear();
        for (const Json& dt : given->is_array() ? *given : Json::array({*given})) {
            if (!dt.is_number()) return fail("bad-type", "\"dt\" must be a number, or a list of numbers.");
            IMOMUSHI_TRY(const auto value, numberWithin(dt, "dt", 0.0, kLongestFrame));
            if (value <= 0.0) return fail("bad-value", "\"dt\" must be larger than 0 seconds.");
            times.push_back(value);
        }
    }
    IMOMUSHI_TRY(const auto alive, live.built());
    std::vector<StepInput> inputs;
    if (const Json* given = find(arguments, "inputs")) {
        IMOMUSHI_TRY(inputs, stepInputs(*given, count, document, live.plan()));
    }
    auto input = inputs.begin();
    std::vector<double> total, pose, joints, product, normals;
    std::array<std::vector<double>, kEffects> effects;
    unsigned warnings = 0;
    bool finite = true, timeDropped = false;
    live.hidePositions();
    const Character* character = alive;
    Json met = Json::array();
    std::set<PartId> known = document.effects[EffectKind::Contact].elements;
    for (int frame = 0; frame < count; ++frame) {
        if (progress.cancelled()) return fail(kCancelled, "Stepping was cancelled.");
        for (; input != inputs.end() && input->frame == frame; ++input) (void)live.apply(input->input);
        const auto start = std::chrono::steady_clock::now();
        live.stepFrame(times[times.size() > 1 ? static_cast<std::size_t>(frame) : 0]);
        total.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        if (!character) continue;
        const Character::Stats& stats = character->stats();
        warnings |= live.warnings();
        timeDropped = timeDropped || live.droppedTime();
        for (std::size_t k = 0; k < kEffects; ++k)
            if (const auto ms = live.effectMilliseconds(static_cast<EffectKind>(k))) effects[k].push_back(*ms);
        pose.push_back(stats.poseMs);
        joints.push_back(stats.jointsMs);
        product.push_back(stats.productMs);
        normals.push_back(stats.normalsMs);
        finite = finite && isFinite(*character, document.pose, live.plan().elements.size());
        if (auto ok = pressWhatMet(access, known, met, progress); !ok) return tl::unexpected(ok.error());
        IMOMUSHI_TRY(character, live.built());
    }
    access.changedPose();
    Json answer;
    answer["frames"] = count;
    answer["ms_per_frame"] = summary(std::move(total));
    answer["stages"] = {{"pose", summary(std::move(pose))},
                        {"joints", summary(std::move(joints))},
                        {"product", summary(std::move(product))},
                        {"normals", summary(std::move(normals))}};
    // What the number format costs in accuracy, beside what it saves in time.
    answer["format"] = formatName(document.settings.format);
    answer["format_error"] = character ? character->formatError() : 0.0;
    answer["effects"] = Json::object();
    for (std::size_t k = 0; k < kEffects; ++k)
        if (!effects[k].empty()) answer["effects"][std::string(effectName(static_cast<EffectKind>(k)))] = summary(std::move(effects[k]));
    std::vector<std::string> said = live.warningTexts(warnings);
    if (timeDropped) said.emplace_back("A frame lasted longer than a quarter of a second: bone dynamics moved for that long only; step with a smaller dt.");
    answer["warnings"] = texts(said);
    answer["finite"] = finite;
    if (!met.empty()) answer["met"] = std::move(met);
    return answer;
}

}  // namespace

void addPoseCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey endpoint{"endpoint", Type::Text, true, "\"bone/start\" or \"bone/end\", or a handle."};
    registry.addChange("pin", "Holds an endpoint where it is, a handle as it is turned too, until it is unpinned.",
                       {endpoint, {"orientation", Type::Boolean, false, "Of an endpoint: its bone keeps its direction, too, to a degree; false: it turns freely again, as before."}}, pin);
    registry.addChange("unpin", "Lets a pinned endpoint or handle go.", {endpoint}, unpin);
    registry.addChange("drag",
                       "Moves an endpoint or a handle; it stays held at the target until it is released. Without seconds the static pose is found before the answer.",
                       {endpoint,
                        {"to", Type::Vector3, true, "Where to, metres. Out of reach: as near as the bones can stretch."},
                        {"roll", Type::Number, false, "Twist of the bone's end about its axis, radians from rest."},
                        {"rotation", Type::Array, false, "How a handle is turned from rest, a quaternion [x,y,z,w] (as it is)."},
                        {"seconds", Type::Number, false, "Glides there in this time while step runs."}},
                       drag, showDrag);
    registry.addChange("release",
                       "Lets dragged endpoints and handles go; the pose stays, handles where the flesh has them. A pin that was dragged stays a pin where it is now.",
                       {{"endpoint", Type::Text, false, "\"bone/start\" or \"bone/end\", or a handle (all unless given)."}},
                       release, showRelease);
    registry.addChange("touch",
                       "Presses a finger into the surface, or moves or lifts one. It pushes, never pulls, and comes and goes smoothly as frames pass. Needs the effect \"touch\".",
                       {{"element", Type::Text, true, "The element."},
                        {"point", Type::Vector3, true, "Where on its surface, metres, in the rest pose; also names the finger afterwards."},
                        {"to", Type::Any, true, "Where that point is pushed, metres, in the world; null lifts the finger."},
                        {"radius", Type::Number, false, "Of the finger tip, metres (as small as the patches allow)."}},
                       putFinger, showTouch);
    registry.addChange("rest", "The rest pose: all dragged endpoints and handles released, pins back at rest, parts not turned, all velocities zero.", {}, rest, showRest);
    registry.addAction("step",
                       "Performs frames: glides, poses, deformation.",
                       {{"frames", Type::Integer, true, "How many, from 1."}, {"dt", Type::Any, false, "Seconds from frame to frame (1/60), up to 10: a number, or one for each frame."},
                        {"inputs", Type::Array, false, "Where what is held already goes before a frame, as a hand or a device gave it: objects {\"frame\":0,\"endpoint\":\"bone/end\",\"to\":[x,y,z]}, for an endpoint with \"roll\", for a handle with \"rotation\"; or {\"frame\":0,\"character\":name,\"morph\":target,\"weight\":w}, or {\"frame\":0,\"effect\":name,\"property\":name,\"value\":number}, of a vector with \"axis\" 0, 1 or 2; frames from 0 and ascending."}},
                       step);
}

}  // namespace imomushi
