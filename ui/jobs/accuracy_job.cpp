// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/accuracy_job.h"

namespace imomushi {

void AccuracyJob::start(StudyInput input) {
    latest_ = std::make_shared<Latest>();
    seen_ = 0;
    error_.reset();
    launch(
        [latest = latest_, input = std::move(input)](const Progress& progress) {
            const auto done = runStudy(
                input,
                [&latest](const AccuracyStudy& study) {
                    const std::scoped_lock lock(latest->mutex);
                    latest->study = study;
                    ++latest->revision;
                },
                progress);
            if (done) return;
            const std::scoped_lock lock(latest->mutex);
            latest->error = done.error();
        },
        [this] {
            takeDone();
            const std::scoped_lock lock(latest_->mutex);
            error_ = latest_->error;
        });
}

void AccuracyJob::takeDone() {
    AccuracyStudy study;
    {
        const std::scoped_lock lock(latest_->mutex);
        if (latest_->revision == seen_) return;
        seen_ = latest_->revision;
        study = latest_->study;
    }
    Q_EMIT arrived(study);
}

}  // namespace imomushi
