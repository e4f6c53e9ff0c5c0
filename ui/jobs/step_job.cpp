// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/step_job.h"

#include <utility>

#include "ui/models/failures.h"

namespace imomushi {

void StepJob::start(StudioDocument& document, const SlowStep& step) {
    result_ = nullptr;
    auto box = std::make_shared<std::shared_ptr<const Result<PreparedStep>>>();
    launch(
        [box, &registry = document.session().registry(), project = document.project(), commands = step.commands(), arrange = step.arrange, lookFurther = step.lookFurther, afterwards = afterwards_](const Progress& progress) {
            *box = std::make_shared<const Result<PreparedStep>>(prepareStep(registry, project, commands, arrange, progress));
            if (progress.cancelled()) return;
            // Without these the step is as good.
            if (**box && afterwards) attempt([&] { afterwards((**box)->after); });
            if (!**box && lookFurther) attempt([&] { lookFurther(project.document); });
        },
        [this, box] { result_ = *box; });
}

}  // namespace imomushi
