// SPDX-License-Identifier: GPL-3.0-or-later
// Avatars: what their files say, and their expressions.
#include <algorithm>
#include <map>

#include "core/base/json_member.h"
#include "core/commands/core_commands.h"
#include "core/document/avatar.h"
#include "core/document/command_support.h"
#include "core/document/morph_weights.h"
#include "core/live/live_character.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

std::string plainText(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
    if (!value.is_array()) return {};
    std::string out;
    for (const Json& item : value)
        if (item.is_string()) out += (out.empty() ? "" : ", ") + item.get<std::string>();
    return out;
}

Result<Json> express(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto character, characterOf(document, text(arguments, "character")));
    const AvatarFacts facts = character->rig ? avatarFacts(*character->rig) : AvatarFacts();
    if (facts.expressions.empty()) return fail("no-such-target", "The file of \"" + character->name + "\" brought no expressions.");
    IMOMUSHI_TRY(const auto weight, numberWithin(arguments.contains("weight") ? arguments.at("weight") : Json(1.0), "weight", 0.0, 1.0));
    const std::string& name = text(arguments, "expression");
    const auto found = std::find_if(facts.expressions.begin(), facts.expressions.end(), [&](const AvatarExpression& e) { return e.name == name; });
    if (found == facts.expressions.end()) {
        std::string known;
        for (const AvatarExpression& e : facts.expressions) known += (known.empty() ? "\"" : ", \"") + e.name + "\"";
        return fail("no-such-target", "\"" + character->name + "\" has no expression \"" + name + "\"; it has " + known + ".");
    }
    // One face at a time: what other expressions move goes back, what none moves stays.
    std::map<int, double> weights;
    for (const AvatarExpression& e : facts.expressions)
        for (const auto& [target, part] : e.morphs)
            if (const int t = character->model->morphIndex(target); t >= 0) weights.try_emplace(t, character->model->morphs[static_cast<std::size_t>(t)].atRest);
    Json moved = Json::object();
    for (const auto& [target, part] : found->morphs)
        if (const int t = character->model->morphIndex(target); t >= 0) {
            weights[t] += weight * part;
            moved[target] = weights[t];
        }
    for (const auto& [t, w] : weights) {
        if (w == character->model->morphs[static_cast<std::size_t>(t)].atRest)
            document.morphs.erase({character->id, t});
        else
            document.morphs.insert_or_assign({character->id, t}, w);
    }
    return Json{{"morphs", std::move(moved)}};
}

Result<Json> showExpression(LiveCharacter& live, const Json&, Json answer) {
    if (auto alive = live.built(); !alive) return tl::unexpected(alive.error());
    live.showPose();
    return answer;
}

}  // namespace

AvatarFacts avatarFacts(const Rig& rig) {
    AvatarFacts facts;
    const Json avatar = Json::parse(rig.avatar, nullptr, false);
    facts.version = plainText(jsonMember(avatar, "version"));
    // Of 0.x its own words count.
    const Json& licence = jsonMember(avatar, "original").is_object() ? jsonMember(avatar, "original") : jsonMember(avatar, "meta");
    if (licence.is_object())
        for (const auto& [key, value] : licence.items())
            if (std::string said = plainText(value); !said.empty()) facts.licence.emplace_back(key, std::move(said));
    for (const Json& from : jsonMember(avatar, "expressions")) {
        AvatarExpression expression{plainText(jsonMember(from, "name")), {}};
        for (const Json& morph : jsonMember(from, "morphs"))
            if (const Json& weight = jsonMember(morph, "weight"); weight.is_number() && jsonMember(morph, "target").is_string())
                expression.morphs.emplace_back(plainText(jsonMember(morph, "target")), std::clamp(weight.get<double>(), 0.0, 1.0));
        if (!expression.name.empty()) facts.expressions.push_back(std::move(expression));
    }
    facts.springs = jsonMember(jsonMember(avatar, "springBone"), "springs").size();
    facts.firstPerson = !jsonMember(avatar, "firstPerson").empty();
    facts.lookAt = jsonMember(avatar, "lookAt").is_object();
    return facts;
}

std::optional<int> shownExpression(const Document& document, const CharacterSource& character, const std::vector<AvatarExpression>& expressions) {
    std::map<int, double> now;
    for (const AvatarExpression& e : expressions)
        for (const auto& [target, part] : e.morphs)
            if (const int t = character.model->morphIndex(target); t >= 0) now[t] = morphWeight(document, character, t) - character.model->morphs[static_cast<std::size_t>(t)].atRest;
    const auto shows = [&](const AvatarExpression* e) {
        std::map<int, double> wanted;
        for (const auto& [t, weight] : now) wanted[t] = 0.0;
        for (std::size_t i = 0; e && i < e->morphs.size(); ++i)
            if (const int t = character.model->morphIndex(e->morphs[i].first); t >= 0) wanted[t] += e->morphs[i].second;
        return wanted == now;
    };
    if (shows(nullptr)) return -1;
    for (std::size_t i = 0; i < expressions.size(); ++i)
        if (shows(&expressions[i])) return static_cast<int>(i);
    return std::nullopt;
}

Json avatarJson(const Rig& rig) {
    const AvatarFacts facts = avatarFacts(rig);
    Json licence = Json::object(), expressions = Json::array();
    for (const auto& [key, said] : facts.licence) licence[key] = said;
    for (const AvatarExpression& e : facts.expressions) {
        Json morphs = Json::object();
        for (const auto& [target, weight] : e.morphs) morphs[target] = weight;
        expressions.push_back({{"name", e.name}, {"morphs", std::move(morphs)}});
    }
    return Json{{"version", facts.version}, {"licence", std::move(licence)}, {"expressions", std::move(expressions)}, {"springs", facts.springs}, {"first_person", facts.firstPerson}, {"look_at", facts.lookAt}};
}

void addAvatarCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("express",
                       "Shows an expression that came with an avatar (VRM): its morph targets get their weights, those of its other expressions go back to rest.",
                       {{"character", Type::Text, true, "The character."},
                        {"expression", Type::Text, true, "Its name; open and list tell them in \"avatar\"."},
                        {"weight", Type::Number, false, "0: none of it, 1: all of it (1)."}},
                       express, showExpression);
}

}  // namespace imomushi
