// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "ui/jobs/background_job.h"

namespace imomushi {

/// Makes in the background what checking a pose needs first (Session::missingWatches()).
class WatchJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(std::vector<std::function<void()>> missing);
};

}  // namespace imomushi
