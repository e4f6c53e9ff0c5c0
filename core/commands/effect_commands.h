// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// Sets a property of an effect. Errors: "no-such-property", "bad-value", "bad-type".
Result<void> setEffect(Effects& effects, EffectKind kind, const std::string& property, const Json& value);
/// Names of the effects that are on; `all`: every effect with its settings.
Json effectsJson(const Document& document, bool all);
/// All settings of effects with units and ranges, for `imomushi run --help`.
std::string effectsHelp();

}  // namespace imomushi
