// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/effect_commands.h"

#include <algorithm>
#include <cmath>

#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/effect_meetings.h"
#include "core/document/names.h"
#include "core/live/performance.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

Result<EffectKind> effectOf(const Json& arguments) {
    const std::string& name = text(arguments, "effect");
    if (const auto kind = effectNamed(name)) return *kind;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < kEffects; ++k) names.emplace_back(effectName(static_cast<EffectKind>(k)));
    return fail("no-such-effect", "There is no effect \"" + name + "\": " + listNames(names) + ".");
}

struct Wanted {
    EffectKind kind;
    PartId target = 0;  // an element, 0: all
};

/// What "effect" and "target" name. Errors: "no-such-effect", "no-such-element", "bad-target".
Result<Wanted> wantedOf(const Document& document, const Json& arguments) {
    IMOMUSHI_TRY(const auto kind, effectOf(arguments));
    const Json* target = find(arguments, "target");
    if (!target || *target == "character") return Wanted{kind};
    IMOMUSHI_TRY(const auto element, elementOf(document, target->get_ref<const std::string&>()));
    if (!isOfElements(kind))
        return fail("bad-target", "\"" + std::string(effectName(kind)) + "\" works on the whole character: leave \"target\" out.");
    return Wanted{kind, element->id};
}

Json names(const Document& document, const Effect& effect, bool canWait) {
    if (effect.elements.empty() && !(effect.automatic && canWait)) return "character";
    Json list = Json::array();
    for (const auto& [id, element] : document.elements)
        if (effect.elements.contains(id)) list.push_back(element->name);
    return list;
}

Result<Json> enable(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto wanted, wantedOf(document, arguments));
    const auto [kind, target] = wanted;
    const Json* given = find(arguments, "auto");
    const bool automatic = given ? given->get<bool>() : document.effects[kind].automatic;
    if (automatic && !effectDescriptor(kind).canBeAutomatic)
        return fail("not-automatic", "\"" + std::string(effectName(kind)) + "\" cannot wait for poses that call for it: leave \"auto\" out.");
    if (automatic && target != 0 && canWait(kind))
        return fail("bad-target", "\"" + std::string(effectName(kind)) + "\" with \"auto\" finds its elements by itself: leave \"target\" out.");
    Effect& effect = document.effects[kind];
    effect.automatic = automatic;
    if (target == 0)
        effect.elements.clear();
    else if (!effect.enabled)
        effect.elements = {target};
    else if (!effect.elements.empty())
        effect.elements.insert(target);
    effect.enabled = true;
    Json answer;
    answer["on"] = names(document, effect, canWait(kind));
    if (automatic) answer["auto"] = true;
    const EffectCost cost = effectCost(edit.document, edit.responses(), kind);
    answer["columns"] = cost.columns;
    answer["bytes"] = cost.bytes;
    answer["ms_per_frame"] = cost.milliseconds;
    answer["precompute_seconds"] = cost.seconds;
    answer["precompute"] = cost.precompute;
    return answer;
}

Result<Json> disable(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto wanted, wantedOf(document, arguments));
    const auto [kind, target] = wanted;
    Effect& effect = document.effects[kind];
    if (!document.effects.has(kind) || (target != 0 && !document.effects.has(kind, target)))
        return fail("not-enabled", "\"" + std::string(effectName(kind)) + "\" is not enabled" + (target ? " there." : "."));
    if (target != 0 && waitsToMeet(document.effects, kind))
        return fail("bad-target", "\"" + std::string(effectName(kind)) + "\" with \"auto\" finds its elements by itself: leave \"target\" out.");
    if (target != 0) {
        if (effect.elements.empty())
            for (const auto& [id, element] : document.elements) effect.elements.insert(id);
        effect.elements.erase(target);
    }
    if (target == 0 || effect.elements.empty()) {
        effect.elements.clear();
        effect.enabled = effect.automatic = false;
    }
    if (kind == EffectKind::Touch)
        std::erase_if(document.touches, [&](const Touch& touch) { return !document.effects.has(EffectKind::Touch, touch.element); });
    return Json{{"on", effect.enabled ? names(document, effect, canWait(kind)) : Json::array()}};
}

}  // namespace

Result<void> setEffect(Effects& effects, EffectKind kind, const std::string& property, const Json& value) {
    std::vector<std::string> known;
    int at = 0;
    for (const EffectProperty& p : effectProperties(kind)) {
        known.emplace_back(p.name);
        if (p.name == property) {
            double* to = effects[kind].values.data() + at;
            if (p.size == 1) {
                IMOMUSHI_TRY(const auto given, numberWithin(value, property, p.low, p.high));
                *to = given;
                return {};
            }
            const auto given = vector3(value);
            if (!given) return fail("bad-type", "\"" + property + "\" must be three numbers [x,y,z].");
            for (int i = 0; i < 3; ++i)
                if (!((*given)[i] >= p.low && (*given)[i] <= p.high)) return tl::unexpected(numberWithin((*given)[i], property, p.low, p.high).error());
            Vec3::Map(to) = *given;
            return {};
        }
        at += p.size;
    }
    return fail("no-such-property", "The effect \"" + std::string(effectName(kind)) + "\" has no property \"" + property + "\": " + listNames(known) + ".");
}

Json effectsJson(const Document& document, bool all) {
    Json list = Json::array();
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        if (document.effects.has(kind)) list.push_back(std::string(effectName(kind)));
    }
    if (!all) return list;
    Json details = Json::object();
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        const Effect& effect = document.effects[kind];
        Json one;
        one["enabled"] = effect.enabled;
        if (effect.automatic) one["auto"] = true;
        if (effect.enabled) one["on"] = names(document, effect, canWait(kind));
        for (const EffectProperty& p : effectProperties(kind))
            one[std::string(p.name)] = p.size == 3 ? json(document.effects.vector(kind, p.name)) : Json(document.effects.number(kind, p.name));
        details[std::string(effectName(kind))] = std::move(one);
    }
    return details;
}

std::string effectsHelp() {
    std::string help;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        if (effectProperties(kind).empty()) continue;
        help += " " + std::string(effectName(kind)) + ":";
        const char* separator = " ";
        for (const EffectProperty& p : effectProperties(kind)) {
            const auto number = [](double x) { return Json(x == std::floor(x) && std::abs(x) < 1e6 ? Json(static_cast<std::int64_t>(x)) : Json(x)).dump(); };
            help += separator + std::string(p.name) + " (" + (p.unit.empty() ? "" : std::string(p.unit) + ", ") + number(p.low) + " to " + number(p.high) + ": " + std::string(p.help) + ")";
            separator = ", ";
        }
        help += ".";
    }
    return help;
}

void addEffectCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    std::string list, ofElements, automatic;
    for (std::size_t k = 0; k < kEffects; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        list += (list.empty() ? "\"" : ", \"") + std::string(effectName(kind)) + "\"";
        if (effectDescriptor(kind).canBeAutomatic) automatic += (automatic.empty() ? "" : ", ") + std::string(effectName(kind));
        if (isOfElements(kind)) ofElements += (ofElements.empty() ? "" : ", ") + std::string(effectName(kind));
    }
    const CommandKey effect{"effect", Type::Text, true, "One of " + list + "."};
    registry.addChange("enable", "Turns an effect on and says what it will cost; what is off costs nothing. Some effects need a precompute then.",
                       {effect, {"target", Type::Text, false, "On this element alone (" + ofElements + "); all unless given."},
                        {"auto", Type::Boolean, false, "Only where and while a pose calls for it, element by element, fading in and out; contact: on elements that come near others while step runs, which are precomputed for it then, and not with the ground (" + automatic + "). Unless given: as it is, at first always."}}, enable);
    registry.addChange("disable", "Turns an effect off; its settings stay.",
                       {effect, {"target", Type::Text, false, "On this element alone; all unless given."}}, disable);
}

}  // namespace imomushi
