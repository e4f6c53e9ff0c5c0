// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/live/live_input.h"
#include "core/session/session.h"

namespace imomushi {

// A command takes hold of what live input moves, inputs follow, and a command leaves the answer in the document.

/// The command that grabs the target of an input, at the place where it is shown.
struct TakingHold {
    Json command;
    LiveInput held;  ///< the same place as an input
};
/// None: it needs no hold. Errors: those of Session::poseOf() and positionOf().
Result<std::optional<TakingHold>> takingHoldOf(const Session& session, const LiveInput& input);

/// The command that lets go what takingHoldOf() took hold of; null: nothing holds it any more, or a pin does.
Json releasingOf(const Session& session, const LiveInput& input);

/// The same input with the name that InputDriver has for what it moves: ends of several bones may be the same point.
LiveInput asDriven(const CharacterPlan& plan, LiveInput input);

/// The command that stores the value of an input in the document.
Json leavingOf(const Session& session, const LiveInput& input);

}  // namespace imomushi
