// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// After a frame: flesh that met in it is computed, so that it presses from the next one on. `known`: elements that had met before, then all. Adds the names of new ones to `met`.
/// Errors: those of DocumentResponses::compute().
Result<void> pressWhatMet(SessionAccess& access, std::set<PartId>& known, Json& met, const Progress& progress);

}  // namespace imomushi
