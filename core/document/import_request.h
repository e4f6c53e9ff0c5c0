// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"
#include "core/document/document.h"
#include "core/io/import.h"

namespace imomushi {

/// The keys "path", "unit", "up" and "name" of commands that import a file. Errors: "bad-value", and those of checkNewName().
Result<ImportRequest> importRequestFrom(const Document& document, const Json& arguments);

}  // namespace imomushi
