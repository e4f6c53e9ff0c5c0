// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
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
    /// `arrange`: see prepareStep(); runs on the other thread.
    void start(StudioDocument& document, const Json& command, std::function<void(Session&)> arrange);
    /// Of the last completed run; null before.
    [[nodiscard]] const std::shared_ptr<const Result<PreparedStep>>& result() const { return result_; }

private:
    std::shared_ptr<const Result<PreparedStep>> result_;
};

}  // namespace imomushi
