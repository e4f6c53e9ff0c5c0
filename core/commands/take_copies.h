// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/commands/part_copies.h"

namespace imomushi {

/// Adds the copies to the takes of `document` and returns the names of the takes that changed. `from`: the document before copying. A take whose
/// shapes fit `from` gets shapes for the copies: numbers of the originals unchanged, those of the copies translated by copier.placing().shift.
/// Other takes get the poses of the copied bones only. If a copied bone shares a joint point with a bone that is no copy, no take changes. An element that was copied without its neighbours keeps what they made of its joints, but for shapes of smooth
/// joints, which are those of the neighbours it has. Where the dynamics of the previous model were recorded, poses are all that remains. Errors: those of planCharacter().
Result<std::vector<std::string>> performCopies(Document& document, const Document& from, const PartCopier& copier);

}  // namespace imomushi
