// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/document/character_input.h"
#include "core/document/input_mapping.h"
#include "core/input/input_decoder.h"

namespace imomushi {

/// The diagonal of the box around all elements at rest, m; 1 where there are none.
double characterSize(const Document& document);
/// How far a control moves an end of a bone or a handle unless somebody says otherwise, m: a part of characterSize(), two digits.
double usualReach(const Document& document);

/// Names of bones by the roles that they have of a human ("leftUpperArm"): of the first character that has a head, and arms or legs; else of bones whose names tell.
std::map<std::string, std::string> bonesByRole(const Document& document, const CharacterPlan& plan);
/// What the VMC protocol calls a role of a human: "leftUpperArm" is "LeftUpperArm", as Unity has it, whose thumbs begin one name later.
std::string vmcBoneName(std::string role);
/// What VRM 0 and the VMC protocol call an expression of VRM 1.0: "happy" is "Joy". Others keep their names.
std::string olderExpressionName(std::string_view name);

/// The mappings by which a source drives a character that nobody has mapped yet.
///
/// Pads and keys: limbs are chains of bones that end freely and are not pinned; a hand is one limb, not its fingers. A stick moves the limb that reaches farthest to one side of the scene (-x), a
/// second stick the one that reaches farthest to the other, a third one the highest of what is left; two buttons bring the first two forward (+z). Characters with handles alone have those in the place
/// of limbs. Where there are cycles, the triggers of a pad have how much there is of the first one and how fast it runs, and its shoulders bring
/// limbs forward. Buttons show kept poses that are not of a cycle, else morph targets. One button lets everything go.
///
/// VMC: bones turn by their roles of a human, as the file says them or names tell them; without roles, the head turns the highest limb, and the arms turn the limbs that reach farthest to their sides.
/// Values of a face move expressions of an avatar, or morph targets of the same name.
///
/// A microphone: shapes of the mouth show expressions of an avatar, or morph targets of the same name ("aa"); else loudness opens what is called a mouth or a jaw, or lifts the highest limb.
///
/// OSC and MIDI: none, as senders have no names in common. `source`: who they are for.
InputMappings suggestedMappings(const Document& document, const CharacterPlan& plan, InputProtocol protocol, const std::string& source);

}  // namespace imomushi
