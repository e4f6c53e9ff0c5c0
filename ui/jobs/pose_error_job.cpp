// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/pose_error_job.h"

namespace imomushi {

PoseErrorJob::PoseErrorJob(QObject* parent) : BackgroundJob(parent), keeper_(std::make_shared<FullSolutionKeeper>()) {}

void PoseErrorJob::start(PoseErrorInput input) {
    auto made = std::make_shared<std::optional<Result<PoseErrors>>>();
    launch([keeper = keeper_, made, input = std::move(input)](const Progress& progress) { made->emplace(keeper->measure(input, progress)); },
           [this, made] {
               errors_.reset();
               error_.reset();
               if (Result<PoseErrors>& result = **made)
                   errors_ = std::move(*result);
               else
                   error_ = result.error();
           });
}

void PoseErrorJob::forget() {
    cancel();
    keeper_ = std::make_shared<FullSolutionKeeper>();
    errors_.reset();
    error_.reset();
}

void ReferenceCostJob::start(ReferenceInput input) {
    cost_.reset();
    auto made = std::make_shared<ResponseEstimate>();
    launch([made, input = std::move(input)](const Progress& progress) { *made = referenceCost(input, progress); }, [this, made] { cost_ = *made; });
}

}  // namespace imomushi
