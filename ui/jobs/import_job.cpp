// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/import_job.h"

namespace imomushi {

void ImportJob::start(const ImportRequest& request) {
    request_ = request;
    result_ = nullptr;
    auto box = std::make_shared<std::shared_ptr<const Result<ImportResult>>>();
    launch([request, box](const Progress& progress) { *box = std::make_shared<const Result<ImportResult>>(importFile(request, progress)); },
           [this, box] { result_ = *box; });
}

}  // namespace imomushi
