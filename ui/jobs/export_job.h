// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/document/command.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

struct ExportPlan;

/// Writes and reads back one export in the background, from a copy of what it needs: the document stays usable.
class ExportJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(ExportPlan plan);
    /// What the command "export" answers, of the last completed run; null before.
    [[nodiscard]] std::shared_ptr<const Result<Json>> answer() const { return answer_; }

private:
    std::shared_ptr<const Result<Json>> answer_;
};

}  // namespace imomushi
