// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/document/command_support.h"
#include "core/document/document_edit.h"
#include "core/document/names.h"
#include "core/document/performance.h"
#include "core/elasticity/machine_rates.h"

namespace imomushi {

namespace {

// Of a frame, in pairs of a collocation point and a triangle, whose time is measured on every machine: of a joint with its in-plane stretch alone; what it costs more
// with warping modes, by their number and its square (smooth joints); of a joint that jiggles; of a warped vertex; of an entry of a matrix of tractions. Predictions
// are replaced by what is measured once frames pass.
constexpr double kJointPairs = 26.0, kWarpingPairs = 40.0, kModePairs = 1.0, kModesPairs = 0.86, kJigglePairs = 13.0, kWarpPairs = 1.45, kTractionPairs = 0.006;

Result<EffectKind> effectOf(const Json& arguments) {
    const std::string& name = text(arguments, "effect");
    if (const auto kind = effectNamed(name)) return *kind;
    std::vector<std::string> names(kEffectNames.begin(), kEffectNames.end());
    return fail("no-such-effect", "There is no effect \"" + name + "\": " + listNames(names) + ".");
}

struct Wanted {
    EffectKind kind;
    PartId target = 0;  // an element, 0: all
};

/// What "effect" and "target" name. Errors: "no-such-effect", "no-such-element", "bad-target".
Result<Wanted> wantedOf(const Document& document, const Json& arguments) {
    const auto kind = effectOf(arguments);
    if (!kind) return tl::unexpected(kind.error());
    const Json* target = find(arguments, "target");
    if (!target || *target == "character") return Wanted{*kind};
    const auto element = elementOf(document, target->get_ref<const std::string&>());
    if (!element) return tl::unexpected(element.error());
    if (!isOfElements(*kind))
        return fail("bad-target", "\"" + std::string(effectName(*kind)) + "\" works on the whole character: leave \"target\" out.");
    return Wanted{*kind, (*element)->id};
}

Json names(const Document& document, const Effect& effect) {
    if (effect.elements.empty()) return "character";
    Json list = Json::array();
    for (const auto& [id, element] : document.elements)
        if (effect.elements.contains(id)) list.push_back(element->name);
    return list;
}

Result<Json> enable(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    const auto wanted = wantedOf(document, arguments);
    if (!wanted) return tl::unexpected(wanted.error());
    const auto [kind, target] = *wanted;
    Effect& effect = document.effects[kind];
    if (target == 0)
        effect.elements.clear();
    else if (!effect.enabled)
        effect.elements = {target};
    else if (!effect.elements.empty())
        effect.elements.insert(target);
    effect.enabled = true;
    Json answer;
    answer["on"] = names(document, effect);
    const EffectCost cost = edit.responses().costOf(kind);
    answer["columns"] = cost.columns;
    answer["bytes"] = cost.bytes;
    answer["ms_per_frame"] = cost.milliseconds;
    answer["precompute_seconds"] = cost.seconds;
    answer["precompute"] = cost.precompute;
    return answer;
}

Result<Json> disable(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    const auto wanted = wantedOf(document, arguments);
    if (!wanted) return tl::unexpected(wanted.error());
    const auto [kind, target] = *wanted;
    Effect& effect = document.effects[kind];
    if (!document.effects.has(kind) || (target != 0 && !document.effects.has(kind, target)))
        return fail("not-enabled", "\"" + std::string(effectName(kind)) + "\" is not enabled" + (target ? " there." : "."));
    if (target != 0) {
        if (effect.elements.empty())
            for (const auto& [id, element] : document.elements) effect.elements.insert(id);
        effect.elements.erase(target);
    }
    if (target == 0 || effect.elements.empty()) {
        effect.elements.clear();
        effect.enabled = false;
    }
    if (kind == EffectKind::Touch)
        std::erase_if(document.touches, [&](const Touch& touch) { return !document.effects.has(EffectKind::Touch, touch.element); });
    return Json{{"on", effect.enabled ? names(document, effect) : Json::array()}};
}

}  // namespace

EffectCost DocumentResponses::costOf(EffectKind kind) const {
    const Document& document = document_;
    EffectCost cost;
    if (kind == EffectKind::BoneDynamics || kind == EffectKind::Ground) {
        Document asked = document;
        asked.effects[kind].enabled = true;
        const auto planned = planCharacter(asked);
        if (planned) cost.milliseconds = Performance::predict(asked, *planned);
        return cost;
    }
    const double pairMs = 1e3 * machineRates().secondsPerPair;
    if (kind == EffectKind::SmoothJoints || kind == EffectKind::JointDynamics) {
        const auto planned = planCharacter(document);
        if (!planned) return cost;
        const double joints = static_cast<double>(planned->joints.size());
        const double modes = document.settings.basis == BasisKind::Full ? BasisChoice::kMostModes : document.settings.basis.modes;
        const double warping = modes > 0.0 ? kWarpingPairs + modes * (kModePairs + modes * kModesPairs) : 0.0;
        cost.milliseconds = joints * pairMs * (kind == EffectKind::JointDynamics ? kJigglePairs : kJointPairs + warping);
        return cost;
    }
    if (kind == EffectKind::PreviousModel) {
        const double stepsPerFrame = 1.0 / (60.0 * document.effects.number(kind, "step"));
        for (const auto& [id, element] : document.elements) {
            double columns = 0.0;
            for (const JointFace& face : element->faces) columns += 3.0 * static_cast<double>(face.vertices.size());
            cost.milliseconds += kTractionPairs * pairMs * stepsPerFrame * columns * columns;
            cost.bytes += static_cast<std::size_t>(columns * columns) * sizeof(double);
            cost.precompute = cost.precompute || (columns > 0.0 && (document.settings.basis != BasisKind::Full || !freshOf(id)));
        }
        return cost;
    }
    if (!isOfElements(kind)) return cost;
    const Effect& effect = document.effects[kind];
    for (const auto& [id, element] : document.elements) {
        if (element->faces.empty() || (effect.enabled && !document.effects.has(kind, id))) continue;
        ResponseInput with = inputOf(id), without = with;
        int columns = 0;
        if (kind == EffectKind::Gravity || kind == EffectKind::Inflate) {
            const EffectKind other = kind == EffectKind::Gravity ? EffectKind::Inflate : EffectKind::Gravity;
            with.loads = true;
            without.loads = document.effects.has(other, id);
            columns = kind == EffectKind::Gravity ? 3 : 1;
        } else if (kind == EffectKind::Touch) {
            with.touch = static_cast<int>(std::lround(document.effects.number(kind, "patches")));
            without.touch = 0;
            columns = 3 * with.touch;
        } else {
            cost.milliseconds += kWarpPairs * pairMs * static_cast<double>(element->mesh->body.vertices.rows());
            continue;
        }
        const ResponseEstimate more = estimateOf(with), less = estimateOf(without);
        const bool known = store_->find(responseKey(with)) != nullptr;
        cost.precompute = cost.precompute || !known;
        cost.columns += columns;
        cost.bytes += static_cast<std::size_t>(columns) * static_cast<std::size_t>(3 * element->mesh->body.vertices.rows()) * sizeof(float);
        if (!known && !sharedOf(id)) cost.seconds += more.seconds;
        // Fingers read the columns of the patches around them, about a dozen; the others are read in every frame.
        const int read = kind == EffectKind::Touch ? std::min(columns, 36) : columns;
        if (more.columns > 0) cost.milliseconds += less.frameMilliseconds * read / std::max(1, less.columns);
    }
    return cost;
}

Result<void> setEffect(Effects& effects, EffectKind kind, const std::string& property, const Json& value) {
    std::vector<std::string> known;
    int at = 0;
    for (const EffectProperty& p : effectProperties(kind)) {
        known.emplace_back(p.name);
        if (p.name == property) {
            double* to = effects[kind].values.data() + at;
            if (p.size == 1) {
                const auto given = numberWithin(value, property, p.low, p.high);
                if (!given) return tl::unexpected(given.error());
                *to = *given;
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
        if (effect.enabled) one["on"] = names(document, effect);
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
    std::string list;
    for (const auto name : kEffectNames) list += (list.empty() ? "\"" : ", \"") + std::string(name) + "\"";
    const CommandKey effect{"effect", Type::Text, true, "One of " + list + "."};
    registry.addChange("enable", "Turns an effect on and says what it will cost; what is off costs nothing. Some effects need a precompute then.",
                       {effect, {"target", Type::Text, false, "On this element alone (bend-warp, gravity, inflate, touch); all unless given."}}, enable);
    registry.addChange("disable", "Turns an effect off; its settings stay.",
                       {effect, {"target", Type::Text, false, "On this element alone; all unless given."}}, disable);
}

}  // namespace imomushi
