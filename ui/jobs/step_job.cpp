// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/step_job.h"

#include <utility>

namespace imomushi {

void StepJob::start(const Session& session, const Json& command, std::function<void(Session&)> arrange) {
    result_ = nullptr;
    auto box = std::make_shared<std::shared_ptr<const Result<PreparedStep>>>();
    launch([box, &registry = session.registry(), project = session.project(), command, arrange = std::move(arrange)](
               const Progress& progress) { *box = std::make_shared<const Result<PreparedStep>>(prepareStep(registry, project, command, arrange, progress)); },
           [this, box] { result_ = *box; });
}

}  // namespace imomushi
