// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/accuracy/study.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// A study of what accuracy costs, in the background. Points arrive one by one; what arrived before it was cancelled is kept.
class AccuracyJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(StudyInput input);
    /// Why the last run ended early; none: it did not.
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

signals:
    void arrived(const imomushi::AccuracyStudy& study);

private:
    struct Latest {
        std::mutex mutex;
        AccuracyStudy study;
        std::optional<Error> error;
        int revision = 0;
    };
    void takeDone() override;
    std::shared_ptr<Latest> latest_;
    std::optional<Error> error_;
    int seen_ = 0;
};

}  // namespace imomushi
