// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/export_job.h"

#include "core/commands/export_commands.h"

namespace imomushi {

void ExportJob::start(ExportPlan plan) {
    answer_ = nullptr;
    auto box = std::make_shared<std::shared_ptr<const Result<Json>>>();
    launch([plan = std::make_shared<const ExportPlan>(std::move(plan)), box](const Progress& progress) { *box = std::make_shared<const Result<Json>>(runExport(*plan, progress)); },
           [this, box] { answer_ = *box; });
}

}  // namespace imomushi
