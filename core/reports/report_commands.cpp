// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reports/report_commands.h"

namespace imomushi {

void addReportCommands(CommandRegistry& registry) {
    addPaperCommand(registry);
    addAccuracyCommands(registry);
    addReportCommand(registry);
}

}  // namespace imomushi
