// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/effects.h"

namespace imomushi {

/// Contact that is automatic waits: it is on no element until flesh of two comes near (MeetingJob), and on these from then on. They are Effect::elements.
inline bool canWait(EffectKind kind) { return kind == EffectKind::Contact; }
/// The effect is enabled, and waits for flesh to meet.
inline bool waitsToMeet(const Effects& effects, EffectKind kind) { return canWait(kind) && effects[kind].enabled && effects[kind].automatic; }

}  // namespace imomushi
