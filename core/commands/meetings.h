// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// Computes the patches of elements whose flesh met in the last frame, so that they press from the next one on. `known`: the elements that had met before; afterwards with the new ones, whose
/// names are added to `met`.
/// Errors: those of DocumentResponses::compute().
Result<void> pressWhatMet(SessionAccess& access, std::set<PartId>& known, Json& met, const Progress& progress);

}  // namespace imomushi
