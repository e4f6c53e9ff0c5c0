// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "core/document/command.h"

namespace imomushi {

/// Every command of this program: those of core and those that draw without a display.
CommandRegistry headlessRegistry();

/// One line of a script. Errors: "bad-json" (what is wrong and where), also for doubled keys and deep nesting.
Result<Json> parseScriptLine(const std::string& line);

/// `imomushi run`: performs a script of JSON Lines and prints one answer per command, flushed at once.
/// Returns the exit status: 0 all well, 1 a command failed, 2 a script that cannot be read or bad options.
int runMain(const std::vector<std::string>& arguments, std::istream& in, std::ostream& out, std::ostream& err);

}  // namespace imomushi
