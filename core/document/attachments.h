// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// "flesh", "rigid"; null: "auto".
std::string_view nameOf(const Attachment* attachment);

/// The vertices that the attachment of a part is for: without shells that have their own.
std::vector<std::int32_t> attachedVertices(const CharacterSource& character, const ModelPart& part);

/// The pivot of a part: as chosen, else the middle of the box of its vertices. m, at rest
Vec3 pivotOf(const CharacterSource& character, const ModelPart& part);

/// By its name (ModelParts). Errors: "no-such-part" with the names there are.
Result<ModelPart> modelPartNamed(const CharacterSource& character, std::string_view name);

/// Whether the part moves rigidly by itself, so that it can be turned.
bool isRigid(const CharacterSource& character, const ModelPart& part);

/// The parts of a character and how they follow, for "open" and others.
Json partsJson(const Document& document, const CharacterSource& character);

}  // namespace imomushi
