// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/proposal/proposal_edit.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// Tries in the background what the cuts of a proposal do to a body.
class CutTrialJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(std::shared_ptr<const TriangleMesh> body, Proposal proposal);
    /// Of the last run that was started.
    [[nodiscard]] const Proposal& proposal() const { return *proposal_; }
    /// Of the last completed run; null before. Errors: those of tryCuts().
    [[nodiscard]] const std::shared_ptr<const Result<TriedCuts>>& result() const { return result_; }

private:
    std::shared_ptr<const Proposal> proposal_;
    std::shared_ptr<const Result<TriedCuts>> result_;
};

}  // namespace imomushi
