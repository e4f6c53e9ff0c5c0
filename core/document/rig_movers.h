// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/character/embedded_mesh.h"
#include "core/document/character_input.h"
#include "core/export/rig_nodes.h"

namespace imomushi {

/// What moves the bones of a character's file in exports. A bone of the file is moved by the document bone of the same name, else by one that starts at its head, else by any one that follows it (RigFollower). Bones
/// that have none were merged, by whoever made the cuts: each goes with the element that has most of its flesh, that is with the bone of the file that this element follows;
/// without flesh with its parent, or a root with its first child. `plan`: of the document; `mesh`: of the character there. The character has a rig.
ExportedRig rigMovers(const Document& document, const CharacterPlan& plan, const CharacterSource& character, const EmbeddedMesh& mesh);

}  // namespace imomushi
