// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/session_state.h"

namespace imomushi {

namespace {

constexpr double kLongestGlide = 1e6;       // s
constexpr double kLargestRoll = 1e6;        // radians
constexpr double kLongestFrame = 10.0;      // s
constexpr int kMostFrames = 10'000'000;     // two days of 60 Hz

Json texts(const std::vector<std::string>& list) {
    Json array = Json::array();
    for (const std::string& text : list) array.push_back(text);
    return array;
}

/// What is held at the joint point of `end`: an endpoint of another bone may be the same point.
std::map<EndpointRef, Held>::iterator heldAt(Session::State& s, const EndpointRef& end) {
    const int point = s.plan.pointIndex(end);
    return std::find_if(s.document.held.begin(), s.document.held.end(),
                        [&](const auto& held) { return s.plan.pointIndex(held.first) == point; });
}

Result<EndpointRef> endpointOf(Session::State& s, const Json& arguments) {
    auto end = s.document.endpoint(text(arguments, "endpoint"));
    if (!end) return end;
    if (auto alive = s.live(); !alive) return tl::unexpected(alive.error());
    return end;
}

Result<Json> pin(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    const auto end = endpointOf(s, arguments);
    if (!end) return tl::unexpected(end.error());
    const auto position = s.positionOf(*end);
    if (!position) return tl::unexpected(position.error());
    Document& document = session.edit();
    if (const auto held = heldAt(s, *end); held != document.held.end()) {
        held->second.pinned = true;
    } else {
        Held made;
        made.pinned = true;
        made.target = *position;
        document.held.emplace(*end, made);
    }
    return Json::object();
}

Result<Json> unpin(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    const auto end = endpointOf(s, arguments);
    if (!end) return tl::unexpected(end.error());
    const auto held = heldAt(s, *end);
    if (held == s.document.held.end() || !held->second.pinned)
        return fail("not-pinned", "The endpoint \"" + text(arguments, "endpoint") + "\" is not pinned.");
    session.edit().held.erase(held);
    return Json::object();
}

Result<Json> drag(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    const auto end = endpointOf(s, arguments);
    if (!end) return tl::unexpected(end.error());
    const auto position = s.positionOf(*end);
    if (!position) return tl::unexpected(position.error());
    Held made;
    made.target = *vector3(arguments.at("to"));
    if (const Json* roll = find(arguments, "roll")) {
        const auto given = numberWithin(*roll, "roll", -kLargestRoll, kLargestRoll);
        if (!given) return tl::unexpected(given.error());
        made.roll = *given;
    }
    if (const Json* seconds = find(arguments, "seconds")) {
        const auto given = numberWithin(*seconds, "seconds", 0.0, kLongestGlide);
        if (!given) return tl::unexpected(given.error());
        made.seconds = *given;
    }
    made.from = *position;
    const auto point = static_cast<std::size_t>(s.plan.pointIndex(*end));
    if (!s.document.pose.roll.empty()) made.fromRoll = s.document.pose.roll[point];
    Document& document = session.edit();
    if (const auto held = heldAt(s, *end); held != document.held.end()) {
        made.pinned = held->second.pinned;
        if (!made.roll) made.roll = held->second.roll;
        document.held.erase(held);
    }
    document.held.insert_or_assign(*end, made);
    s.results.clear();
    if (made.seconds > 0.0) return Json{{"seconds", made.seconds}, {"warnings", texts(s.warningTexts(0))}};
    // With bone dynamics the body follows as frames pass.
    if (s.document.effects.has(EffectKind::BoneDynamics))
        return Json{{"distance", (*position - made.target).norm()}, {"position", json(*position)}, {"settled", false}, {"warnings", texts(s.warningTexts(0))}};

    const auto settled = s.settle();
    if (!settled) return tl::unexpected(settled.error());
    const auto now = s.positionOf(*end);
    if (!now) return tl::unexpected(now.error());
    Json answer;
    answer["distance"] = (*now - made.target).norm();
    answer["position"] = json(*now);
    answer["settled"] = settled->settled;
    answer["iterations"] = settled->iterations;
    answer["ms"] = settled->milliseconds;
    answer["warnings"] = texts(s.warningTexts(settled->warnings));
    return answer;
}

Result<Json> release(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    int released = 0;
    const auto let = [&](std::map<EndpointRef, Held>::iterator held) -> Result<std::map<EndpointRef, Held>::iterator> {
        ++released;
        if (!held->second.pinned) return session.edit().held.erase(held);
        // A pin that was dragged stays a pin, where it is now.
        const auto position = s.positionOf(held->first);
        if (!position) return tl::unexpected(position.error());
        Held pinned;
        pinned.pinned = true;
        pinned.target = *position;
        held->second = pinned;
        return std::next(held);
    };
    if (arguments.contains("endpoint")) {
        const auto end = endpointOf(s, arguments);
        if (!end) return tl::unexpected(end.error());
        const auto held = heldAt(s, *end);
        if (held == s.document.held.end()) return fail("not-held", "The endpoint \"" + text(arguments, "endpoint") + "\" is not held.");
        if (auto done = let(held); !done) return tl::unexpected(done.error());
    } else {
        for (auto held = session.edit().held.begin(); held != session.edit().held.end();) {
            auto next = let(held);
            if (!next) return tl::unexpected(next.error());
            held = *next;
        }
    }
    if (released > 0 && s.document.effects.has(EffectKind::BoneDynamics)) {
        if (auto alive = s.live(); !alive) return tl::unexpected(alive.error());
        s.relax();
    }
    return Json{{"released", released}};
}

Result<Json> rest(Session& session, const Json&, const Progress&) {
    Session::State& s = session.state();
    if (auto alive = s.live(); !alive) return tl::unexpected(alive.error());
    Document& document = session.edit();
    document.pose = {};
    document.touches.clear();
    std::erase_if(document.held, [](const auto& held) { return !held.second.pinned; });
    for (auto& [end, held] : document.held) {
        held = {};
        held.pinned = true;
        held.target = s.plan.input.skeleton.points[static_cast<std::size_t>(s.plan.pointIndex(end))];
    }
    s.results.clear();
    s.jumpToPose();
    return Json::object();
}

Result<Json> touch(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    const auto element = elementOf(s.document, text(arguments, "element"));
    if (!element) return tl::unexpected(element.error());
    const PartId id = (*element)->id;
    const Vec3 point = *vector3(arguments.at("point"));
    const Json& to = arguments.at("to");
    const auto target = to.is_null() ? std::optional(Vec3(Vec3::Zero())) : vector3(to);
    if (!target) return fail("bad-type", "\"to\" must be three numbers [x,y,z], or null to lift the finger.");
    double radius = 0.0;
    if (const Json* given = find(arguments, "radius")) {
        const auto value = numberWithin(*given, "radius", 0.0, kMaxCoordinate);
        if (!value) return tl::unexpected(value.error());
        radius = *value;
    }
    auto& touches = session.edit().touches;
    const auto known = std::find_if(touches.begin(), touches.end(), [&](const Touch& t) { return t.element == id && t.point == point; });
    if (to.is_null()) {
        if (known == touches.end()) return fail("not-touched", "No finger is at that point of \"" + (*element)->name + "\": lift it by the point where it was put down.");
        const int finger = known->finger;
        touches.erase(known);
        if (auto alive = s.live(); !alive) return tl::unexpected(alive.error());
        return Json{{"finger", finger}};
    }
    if (!s.document.effects.has(EffectKind::Touch, id))
        return fail("not-enabled", "Fingers need the effect \"touch\" on \"" + (*element)->name + "\": enable it, and precompute.");
    const auto alive = s.live();
    if (!alive) return tl::unexpected(alive.error());
    const auto response = s.responseOf(id, true);
    if (!response || response->touch.columns() == 0)
        return fail("not-precomputed", "\"" + (*element)->name + "\" is not precomputed for fingers: precompute it (it needs a joint face that holds it).");
    Touch made{id, 0, point, *target, radius};
    if (known != touches.end()) {
        made.finger = known->finger;
    } else {
        const auto taken = [&](int finger) {
            return std::any_of(touches.begin(), touches.end(), [&](const Touch& t) { return t.element == id && t.finger == finger; });
        };
        while (made.finger < TouchContact::kFingers && taken(made.finger)) ++made.finger;
        if (made.finger == TouchContact::kFingers)
            return fail("too-many-fingers", "\"" + (*element)->name + "\" has " + std::to_string(TouchContact::kFingers) + " fingers already: lift one.");
    }
    if (!s.character->setFinger(s.plan.elementIndex(id), made.finger, point, *target, radius))
        return fail("not-touchable", "That point of \"" + (*element)->name + "\" cannot be touched: choose one of its free surface.");
    if (known != touches.end())
        *known = made;
    else
        touches.push_back(made);
    s.showPose();
    return Json{{"finger", made.finger}};
}

bool isFinite(const Character& character, const Pose& pose, std::size_t elements) {
    for (const Vec3& p : pose.points)
        if (!p.allFinite()) return false;
    for (std::size_t e = 0; e < elements; ++e) {
        const auto surface = character.surface(static_cast<int>(e));
        for (int i = 0; i < 3 * surface.vertices; ++i)
            if (!std::isfinite(surface.positions[i]) || !std::isfinite(surface.normals[i])) return false;
    }
    return true;
}

Result<Json> step(Session& session, const Json& arguments, const Progress& progress) {
    Session::State& s = session.state();
    const auto frames = numberWithin(arguments.at("frames"), "frames", 1, kMostFrames);
    if (!frames) return tl::unexpected(frames.error());
    const int count = static_cast<int>(*frames);
    std::vector<double> times = {1.0 / 60.0};
    if (const Json* given = find(arguments, "dt")) {
        if (given->is_array() && given->size() != static_cast<std::size_t>(count)) return fail("bad-value", "\"dt\" must have a number for each frame.");
        times.clear();
        for (const Json& dt : given->is_array() ? *given : Json::array({*given})) {
            if (!dt.is_number()) return fail("bad-type", "\"dt\" must be a number, or a list of numbers.");
            const auto value = numberWithin(dt, "dt", 0.0, kLongestFrame);
            if (!value) return tl::unexpected(value.error());
            if (*value <= 0.0) return fail("bad-value", "\"dt\" must be larger than 0 seconds.");
            times.push_back(*value);
        }
    }
    const auto alive = s.live();
    if (!alive) return tl::unexpected(alive.error());
    std::vector<double> total, pose, joints, product, normals;
    std::array<std::vector<double>, kEffects> effects;
    unsigned warnings = 0;
    bool finite = true, timeDropped = false;
    s.results.clear();
    for (int frame = 0; frame < count; ++frame) {
        if (progress.cancelled()) return fail(kCancelled, "Stepping was cancelled.");
        const auto start = std::chrono::steady_clock::now();
        session.stepFrame(times[times.size() > 1 ? static_cast<std::size_t>(frame) : 0]);
        total.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        if (!s.character) continue;
        const Character::Stats& stats = s.character->stats();
        warnings |= stats.warnings;
        timeDropped = timeDropped || (s.performance && (s.performance->warnings() & static_cast<unsigned>(DynamicsWarning::TimeDropped)) != 0);
        for (std::size_t k = 0; k < kEffects; ++k)
            if (s.effectMs[k] >= 0.0) effects[k].push_back(s.effectMs[k]);
        pose.push_back(stats.poseMs);
        joints.push_back(stats.jointsMs);
        product.push_back(stats.productMs);
        normals.push_back(stats.normalsMs);
        finite = finite && isFinite(*s.character, s.document.pose, s.plan.elements.size());
    }
    s.pending.pose = true;
    Json answer;
    answer["frames"] = count;
    answer["ms_per_frame"] = summary(std::move(total));
    answer["stages"] = {{"pose", summary(std::move(pose))},
                        {"joints", summary(std::move(joints))},
                        {"product", summary(std::move(product))},
                        {"normals", summary(std::move(normals))}};
    // What the number format costs in accuracy, beside what it saves in time.
    answer["format"] = formatName(s.document.settings.format);
    answer["format_error"] = s.character ? s.character->formatError() : 0.0;
    answer["effects"] = Json::object();
    for (std::size_t k = 0; k < kEffects; ++k)
        if (!effects[k].empty()) answer["effects"][std::string(kEffectNames[k])] = summary(std::move(effects[k]));
    std::vector<std::string> said = s.warningTexts(warnings);
    if (timeDropped) said.emplace_back("A frame lasted longer than a quarter of a second: bone dynamics moved for that long only; step with a smaller dt.");
    answer["warnings"] = texts(said);
    answer["finite"] = finite;
    return answer;
}

}  // namespace

void addPoseCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey endpoint{"endpoint", Type::Text, true, "\"bone/start\" or \"bone/end\"."};
    registry.add({"pin", "Holds an endpoint where it is, until it is unpinned.", {endpoint}, true, pin});
    registry.add({"unpin", "Lets a pinned endpoint go.", {endpoint}, true, unpin});
    registry.add({"drag",
                  "Moves an endpoint; it stays held at the target until it is released. Without seconds the static pose is found before the answer.",
                  {endpoint,
                   {"to", Type::Vector3, true, "Where to, metres. Out of reach: as near as the bones can stretch."},
                   {"roll", Type::Number, false, "Twist of the bone's end about its axis, radians from rest."},
                   {"seconds", Type::Number, false, "Glides there in this time while step runs."}},
                  true, drag});
    registry.add({"release",
                  "Lets dragged endpoints go; the pose stays. A pin that was dragged stays a pin where it is now.",
                  {{"endpoint", Type::Text, false, "\"bone/start\" or \"bone/end\" (all unless given)."}},
                  true, release});
    registry.add({"touch",
                  "Presses a finger into the surface, or moves or lifts one. It pushes, never pulls, and comes and goes smoothly as frames pass. Needs the effect \"touch\".",
                  {{"element", Type::Text, true, "The element."},
                   {"point", Type::Vector3, true, "Where on its surface, metres, in the rest pose; also names the finger afterwards."},
                   {"to", Type::Any, true, "Where that point is pushed, metres, in the world; null lifts the finger."},
                   {"radius", Type::Number, false, "Of the finger tip, metres (as small as the patches allow)."}},
                  true, touch});
    registry.add({"rest", "The rest pose: all dragged endpoints released, pins back at rest, all velocities zero.", {}, true, rest});
    registry.add({"step",
                  "Performs frames: glides, poses, deformation.",
                  {{"frames", Type::Integer, true, "How many, from 1."}, {"dt", Type::Any, false, "Seconds from frame to frame (1/60), up to 10: a number, or one for each frame."}},
                  false, step});
}

}  // namespace imomushi
