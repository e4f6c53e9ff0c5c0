// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/document/command.h"

namespace imomushi {

/// Commands that compare and report: the paper's table, studies of accuracy, reports. Adds to `registry`.
void addReportCommands(CommandRegistry& registry);

void addPaperCommand(CommandRegistry& registry);      // paper
void addAccuracyCommands(CommandRegistry& registry);  // accuracy
void addReportCommand(CommandRegistry& registry);     // report

}  // namespace imomushi
