// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/live/live_character.h"

namespace imomushi {

/// What the shown pose does to an element that its present setting cannot show, and what would mend it.
struct PoseFinding {
    enum class Kind {  // the worst first
        Fold,      ///< triangles turn inside out
        Crossing,  ///< it passes through the plane of a joint face
        Volume,    ///< off by more than 2 %
        Crease,    ///< it leaves a joint face at an angle
        Twist,     ///< the basis cannot say how its faces turn
    };
    PartId element = 0;
    Kind kind = Kind::Fold;
    double measure = 0.0;               ///< a ratio; of a crease and of a twist: radians
    std::optional<EffectKind> mend;     ///< none: another basis does
};

/// "fold", "crossing", "volume", "crease", "twist".
std::string_view poseFindingName(PoseFinding::Kind kind);

/// Of all elements, at most one finding of a kind each, by elements. Elements whose bend warp is on, or comes by itself, leave nothing. Takes microseconds per
/// element; the first time for a character, tables are made. Errors: those of LiveCharacter::built().
Result<std::vector<PoseFinding>> checkPose(LiveCharacter& live);

/// The effect that mends the worst finding, in the order of kinds. Nullopt: none does.
std::optional<EffectKind> mendOf(const std::vector<PoseFinding>& findings);

}  // namespace imomushi
