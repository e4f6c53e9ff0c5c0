// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/accuracy_job.h"

namespace imomushi {

AccuracyJob::AccuracyJob(QObject* parent) : BackgroundJob(parent) {
    connect(this, &BackgroundJob::progressed, this, &AccuracyJob::take);
}

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
            take();
            const std::scoped_lock lock(latest_->mutex);
            error_ = latest_->error;
        });
}

void AccuracyJob::take() {
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
