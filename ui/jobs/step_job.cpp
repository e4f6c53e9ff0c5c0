// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/step_job.h"

#include <utility>

namespace imomushi {

void StepJob::start(StudioDocument& document, const Json& command, std::function<void(Session&)> arrange) {
    result_ = nullptr;
    auto box = std::make_shared<std::shared_ptr<const Result<PreparedStep>>>();
    launch([box, &registry = document.session().registry(), project = document.project(), command, arrange = std::move(arrange)](
               const Progress& progress) { *box = std::make_shared<const Result<PreparedStep>>(prepareStep(registry, project, command, arrange, progress)); },
           [this, box] { result_ = *box; });
}

}  // namespace imomushi
