// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "core/accuracy/pose_error.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// The error of the character in one pose, in the background. The full solution is kept for the next pose.
class PoseErrorJob : public BackgroundJob {
    Q_OBJECT
public:
    explicit PoseErrorJob(QObject* parent = nullptr);
    void start(PoseErrorInput input);
    /// The full solution of this character is there: start() takes a moment.
    [[nodiscard]] bool knows(const ContentKey& reference) const { return keeper_->knows(reference); }
    /// Gives the full solution back.
    void forget();
    /// For a study, which solves the same.
    [[nodiscard]] std::shared_ptr<FullSolutionKeeper> keeper() const { return keeper_; }

    /// Of the last start(), or why there is nothing.
    [[nodiscard]] const std::optional<PoseErrors>& errors() const { return errors_; }
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

private:
    std::shared_ptr<FullSolutionKeeper> keeper_;  // shared with a thread that was cancelled and has not noticed yet
    std::optional<PoseErrors> errors_;
    std::optional<Error> error_;
};

/// What the full solution of a character would cost, in the background.
class ReferenceCostJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(ReferenceInput input);
    [[nodiscard]] const std::optional<ResponseEstimate>& cost() const { return cost_; }

private:
    std::optional<ResponseEstimate> cost_;
};

}  // namespace imomushi
