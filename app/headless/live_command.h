// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "core/document/command.h"

namespace imomushi {

/// Adds "live" and "replay": a character is performed by what other programs send, without a window.
void addLiveCommands(CommandRegistry& registry);

/// `imomushi live` and `imomushi replay`: a project is opened, performed and saved. `arguments`: from the name of the sub-command on. Exit status as runMain().
int liveMain(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& err);

}  // namespace imomushi
