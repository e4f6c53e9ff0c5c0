// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/progress_text.h"

#include "ui/jobs/background_job.h"
#include "ui/models/texts.h"

namespace imomushi {

QString progressText(const BackgroundJob& job) {
    const double left = job.secondsLeft();
    if (left < 0.0) return job.stage();
    return BackgroundJob::tr("%1 · %2 left", "stage, time").arg(job.stage(), durationText(left));
}

}  // namespace imomushi
