// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/hold_inputs.h"

#include <algorithm>

#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/morph_weights.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

Json turnJson(const Eigen::Quaterniond& q) { return Json::array({q.x(), q.y(), q.z(), q.w()}); }

const std::string& handleName(const Session& session, const LiveInput& input) { return session.plan().handles[static_cast<std::size_t>(input.handle)].face; }

/// What a number is now.
double numberOf(const Document& document, const LiveInput& input) {
    if (input.kind == LiveInput::Kind::Effect) return document.effects[input.effect].values[static_cast<std::size_t>(input.value)];
    return morphWeight(document, *document.characters.at(input.morph.character), input.morph.target);
}

}  // namespace

Result<std::optional<TakingHold>> takingHoldOf(const Session& session, const LiveInput& input) {
    TakingHold made{{{"do", "drag"}}, input};
    made.held.rotation.setIdentity();
    made.held.roll = 0.0;
    switch (input.kind) {
        case LiveInput::Kind::Handle: {
            IMOMUSHI_TRY(const auto shown, session.poseOf(session.plan().handles[static_cast<std::size_t>(input.handle)]));
            made.held.target = shown.at;
            made.held.rotation = shown.rotation;
            made.command["endpoint"] = handleName(session, input);
            made.command["rotation"] = turnJson(shown.rotation);
            break;
        }
        case LiveInput::Kind::End: {
            IMOMUSHI_TRY(made.held.target, session.positionOf(input.end));
            made.command["endpoint"] = endpointText(session.document(), input.end);
            break;
        }
        case LiveInput::Kind::Morph:
        case LiveInput::Kind::Effect:
            made.held.weight = numberOf(session.document(), input);
            made.command = leavingOf(session, made.held);
            return std::optional(std::move(made));
    }
    made.command["to"] = json(made.held.target);
    return std::optional(std::move(made));
}

Json releasingOf(const Session& session, const LiveInput& input) {
    const Document& document = session.document();
    if (input.kind == LiveInput::Kind::Handle) {
        const auto goal = document.handleGoals.find(session.plan().handles[static_cast<std::size_t>(input.handle)]);
        return goal != document.handleGoals.end() && goal->second.target.held ? Json{{"do", "release"}, {"endpoint", handleName(session, input)}} : Json();
    }
    const int point = session.plan().pointIndex(input.end);
    for (const auto& [end, goal] : document.goals)
        if (point >= 0 && session.plan().pointIndex(end) == point) return goal.pinned ? Json() : Json{{"do", "release"}, {"endpoint", endpointText(document, input.end)}};
    return nullptr;
}

LiveInput asDriven(const CharacterPlan& plan, LiveInput input) {
    if (input.kind != LiveInput::Kind::End) return input;
    const int point = plan.pointIndex(input.end);
    const auto first = std::find_if(plan.points.begin(), plan.points.end(), [&](const auto& end) { return end.second == point; });
    if (first != plan.points.end()) input.end = first->first;
    return input;
}

Json leavingOf(const Session& session, const LiveInput& input) {
    const Document& document = session.document();
    if (input.kind == LiveInput::Kind::Morph) {
        const CharacterSource& character = *document.characters.at(input.morph.character);
        return {{"do", "morph"}, {"character", character.name}, {"target", character.model->morphs[static_cast<std::size_t>(input.morph.target)].name}, {"weight", input.weight}};
    }
    if (input.kind == LiveInput::Kind::Effect) {
        const auto& [property, first] = propertyOf(input);
        Json value = input.weight;
        if (property.size == 3) {
            Vec3 now = document.effects.vector(input.effect, property.name);
            now[input.value - first] = input.weight;
            value = json(now);
        }
        return {{"do", "set"}, {"target", effectName(input.effect)}, {"property", property.name}, {"value", value}};
    }
    Json command{{"do", "drag"}, {"endpoint", input.kind == LiveInput::Kind::Handle ? handleName(session, input) : endpointText(document, input.end)}, {"to", json(input.target)}};
    if (input.kind == LiveInput::Kind::Handle)
        command["rotation"] = turnJson(input.rotation);
    else if (input.hasRoll)
        command["roll"] = input.roll;
    return command;
}

}  // namespace imomushi
