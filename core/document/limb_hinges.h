// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/character_input.h"

namespace imomushi {

/// Sets Skeleton::Bone::hinge of knees and elbows, and swing and foldSlack where arms move sooner, of characters whose file says what its bones are of a human (humanRoles()). Knees go forward,
/// elbows so that the forearm goes forward, or up where the arm points forward; a limb that is bent at rest bends as it does there. Forward is across the line from right to left and the line from the
/// hips to the head. Bones follow those of the file as a RigFollower has it. `plan`: its bones and skeleton are made.
void addLimbHinges(CharacterPlan& plan, const Document& document);

}  // namespace imomushi
