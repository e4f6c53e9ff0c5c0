// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/watch_job.h"

#include <utility>

namespace imomushi {

void WatchJob::start(std::vector<std::function<void()>> missing) {
    launch(
        [missing = std::move(missing)](const Progress& progress) {
            for (const auto& make : missing)
                if (!progress.cancelled()) make();
        },
        [] {});
}

}  // namespace imomushi
