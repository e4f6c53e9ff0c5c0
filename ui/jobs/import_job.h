// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/io/import.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// Reads one mesh file in the background.
class ImportJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(const ImportRequest& request);
    [[nodiscard]] const ImportRequest& request() const { return request_; }
    /// Of the last completed run; null before.
    [[nodiscard]] std::shared_ptr<const Result<ImportResult>> result() const { return result_; }

private:
    ImportRequest request_;
    std::shared_ptr<const Result<ImportResult>> result_;
};

}  // namespace imomushi
