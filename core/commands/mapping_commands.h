// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// Of the document, which has some; "missing": true where a target is not there.
Json shownMappings(const Document& document);
/// Sources that are calibrated, in which poses, as "list" shows them.
Json shownCalibrations(const Document& document);

}  // namespace imomushi
