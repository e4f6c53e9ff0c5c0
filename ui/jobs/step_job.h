// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <utility>

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
    /// Called on the other thread with the document that a step made: what would be made when somebody first asks is made there.
    void setAfterwards(std::function<void(const Document&)> afterwards) { afterwards_ = std::move(afterwards); }
    /// Of the last completed run; null before. It keeps a character, until dropResult().
    [[nodiscard]] const std::shared_ptr<const Result<PreparedStep>>& result() const { return result_; }
    void dropResult() { result_ = nullptr; }

private:
    std::function<void(const Document&)> afterwards_;
    std::shared_ptr<const Result<PreparedStep>> result_;
};

}  // namespace imomushi
