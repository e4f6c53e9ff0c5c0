// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/pose_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/commands/core_commands.h"
#include "core/commands/session_access.h"
#include "core/document/command_support.h"
#include "core/live/performance.h"

namespace imomushi {

namespace {

constexpr double kVisibleVolume = 0.02;
// Radians: a crease that an artist sees; what shapes of joints smooth away (the bend of an element beyond which they have faded).
constexpr double kVisibleCrease = 0.7, kSmoothBend = 0.45;

Result<Json> checkPoseCommand(SessionAccess& access, const Json&, const Progress&) {
    IMOMUSHI_TRY(const auto findings, checkPose(access.live));
    const Document& document = access.document();
    Json list = Json::array();
    for (const PoseFinding& f : findings) {
        Json one{{"element", document.elements.at(f.element)->name}, {"what", std::string(poseFindingName(f.kind))}, {"measure", f.measure}};
        if (f.mend) one["effect"] = std::string(effectName(*f.mend));
        list.push_back(std::move(one));
    }
    Json answer{{"fits", findings.empty()}, {"leaves", std::move(list)}};
    if (const auto mend = mendOf(findings)) {
        Json command{{"do", "enable"}, {"effect", std::string(effectName(*mend))}};
        if (effectDescriptor(*mend).canBeAutomatic) command["auto"] = true;
        const EffectCost cost = effectCost(access.document(), access.responses, *mend);
        answer["mend"] = {{"command", std::move(command)}, {"ms_per_frame", cost.milliseconds}, {"precompute", cost.precompute}};
    } else if (!findings.empty()) {
        answer["mend"] = {{"command", {{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "affine"}}}, {"precompute", true}};
    }
    return answer;
}

}  // namespace

std::string_view poseFindingName(PoseFinding::Kind kind) {
    static constexpr std::array<std::string_view, 5> kNames = {"fold", "crossing", "volume", "crease", "twist"};
    return kNames[static_cast<std::size_t>(kind)];
}

Result<std::vector<PoseFinding>> checkPose(LiveCharacter& live) {
    IMOMUSHI_TRY(const auto alive, live.built());
    std::vector<PoseFinding> found;
    if (!alive) return found;
    const Document& document = live.document();
    const auto measures = alive->measurePose();
    const bool losesTwist = (alive->stats().warnings & static_cast<unsigned>(FrameWarning::BasisLosesTwist)) != 0;
    for (std::size_t e = 0; e < measures.size(); ++e) {
        const PartId id = live.plan().elements[e];
        const PoseMeasures& m = measures[e];
        if (alive->isWarped(static_cast<int>(e))) continue;
        using Kind = PoseFinding::Kind;
        if (m.area <= 0.0) found.push_back({id, Kind::Fold, m.area, EffectKind::BendWarp});
        if (m.depth <= 0.0) found.push_back({id, Kind::Crossing, m.depth, EffectKind::BendWarp});
        if (std::abs(m.volume) > kVisibleVolume) found.push_back({id, Kind::Volume, m.volume, EffectKind::BendWarp});
        if (m.crease > kVisibleCrease && !(document.effects.has(EffectKind::SmoothJoints) && m.bend < kSmoothBend))
            found.push_back({id, Kind::Crease, m.crease, m.bend < kSmoothBend ? EffectKind::SmoothJoints : EffectKind::BendWarp});
        if (losesTwist && m.bend > 0.0) found.push_back({id, Kind::Twist, m.bend, std::nullopt});
    }
    return found;
}

std::optional<EffectKind> mendOf(const std::vector<PoseFinding>& findings) {
    const auto worst = std::min_element(findings.begin(), findings.end(), [](const PoseFinding& a, const PoseFinding& b) {
        return std::pair(!a.mend, a.kind) < std::pair(!b.mend, b.kind);
    });
    return worst == findings.end() ? std::nullopt : worst->mend;
}

void addPoseCheckCommands(CommandRegistry& registry) {
    registry.addAction("check-pose",
                       "Whether the elements can show the present pose: which fold, cross a joint, lose volume (more than 2 %), crease or lose their twist, and the command that mends it, with its price.",
                       {}, checkPoseCommand);
}

}  // namespace imomushi
