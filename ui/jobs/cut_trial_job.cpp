// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/cut_trial_job.h"

#include <utility>

namespace imomushi {

void CutTrialJob::start(std::shared_ptr<const TriangleMesh> body, Proposal proposal) {
    proposal_ = std::make_shared<const Proposal>(std::move(proposal));
    auto tried = std::make_shared<std::shared_ptr<const Result<TriedCuts>>>();
    launch([tried, body = std::move(body), of = proposal_](const Progress& progress) { *tried = std::make_shared<const Result<TriedCuts>>(tryCuts(*body, *of, progress)); },
           [this, tried] { result_ = *tried; });
}

}  // namespace imomushi
