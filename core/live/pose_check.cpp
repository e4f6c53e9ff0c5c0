// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/live/pose_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/try.h"

namespace imomushi {

namespace {

constexpr double kVisibleVolume = 0.02;
// Radians: a crease that an artist sees; what shapes of joints smooth away (the bend of an element beyond which they have faded).
constexpr double kVisibleCrease = 0.7, kSmoothBend = 0.45;

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

}  // namespace imomushi
