// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/session/prepared_step.h"
#include "ui/jobs/background_job.h"
#include "ui/models/studio_document.h"

namespace imomushi {

/// Executes a command on a copy of the document in the background, for the session to take over.
class StepJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(StudioDocument& document, const SlowStep& step);
    /// Of the last completed run; null before.
    [[nodiscard]] const std::shared_ptr<const Result<PreparedStep>>& result() const { return result_; }

private:
    std::shared_ptr<const Result<PreparedStep>> result_;
};

}  // namespace imomushi
