// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/commands/part_copies.h"

namespace imomushi {

/// Lets shifted copies perform in the takes of a document as what they are copies of, and returns the names of these takes. A take that shows the shapes of `from` shows
/// those of `document` afterwards: the first ones as before, byte for byte, the copies shifted. One that shows poses alone gets those of the copied bones. Copied bones that
/// hang on others are at rest in takes: these lead them. An element that was copied without its neighbours keeps what they made of its joints, but for shapes of smooth
/// joints, which are those of the neighbours it has. Where the dynamics of the previous model were recorded, poses are all that remains. Errors: those of planCharacter().
Result<std::vector<std::string>> performCopies(Document& document, const Document& from, const PartCopier& copier);

}  // namespace imomushi
