// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/document/character_input.h"
#include "core/document/cycle.h"
#include "core/document/kept_pose.h"

namespace imomushi {

/// A cycle with the kept poses that it goes through.
struct SuggestedCycle {
    Cycle cycle;
    std::vector<KeptPose> poses;
};

/// Cycles for any creature, from its skeleton at rest. A chain is bones that go on from end to start, without branching; s is 0 at its root and 1 at its tip, t the phase. Everything is a mean and a
/// first harmonic in t, which poses at 0, 1/3 and 2/3 meet exactly. Angles are those of a bone's direction; each bone turns by the difference to the bone before it.
///
/// "crawl": chains of three bones and more that lie near the ground. Joint points rise by h = k g (1 + cos 2 pi (t - s - o)), so that none goes below its place at rest, and bones turn upwards by the
/// slope of h; where they are lifted they are short. g is 1, or rises from 0 where the root is pinned or hangs on other bones; neighbours among several chains (o) are half a round apart.
/// "sway": bones of chains that end freely turn to the side by a g sin 2 pi (t - w s - o); what lies turns about the vertical. Legs, and what carries them, stand.
/// "breathe": bones through the largest elements get a little longer, by two poses; where there are no bones, handles rise.
/// Joint limits are kept to the half, and bones that are hinges do not turn.
std::vector<SuggestedCycle> suggestedCycles(const Document& document, const CharacterPlan& plan);

}  // namespace imomushi
