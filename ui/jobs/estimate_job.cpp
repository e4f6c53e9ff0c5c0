// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/estimate_job.h"

#include <algorithm>
#include <utility>

#include "core/live/performance.h"
#include "core/project/document_responses.h"

namespace imomushi {

/// Not while changes follow each other.
static constexpr int kEstimateSoonMs = 200;

struct EstimateJob::Work {
    explicit Work(ResponseStore& store) : responses(document, std::shared_ptr<ResponseStore>(std::shared_ptr<void>(), &store)) {}
    Document document;  // a copy; its parts are shared
    DocumentResponses responses;
};

EstimateJob::EstimateJob(StudioDocument& document, std::function<bool()> waits, QObject* parent)
    : BackgroundJob(parent), document_(document), waits_(std::move(waits)), work_(std::make_shared<Work>(document.session().responses().store())) {
    soon_.setSingleShot(true);
    soon_.setInterval(kEstimateSoonMs);
    connect(&soon_, &QTimer::timeout, this, &EstimateJob::start);
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        // Prices of effects depend on joints and bones, too.
        if (change.forResponses() || change.has(&DocumentChange::joints) || change.has(&DocumentChange::bones)) forget();
    });
    connect(&document, &StudioDocument::responsesChanged, this, &EstimateJob::forget);
    forget();
}

void EstimateJob::forget() {
    latest_.reset();
    again_ = running();
    ask();
}

void EstimateJob::ask() {
    if (!latest_ && !running()) soon_.start();
}

void EstimateJob::start() {
    if (running() || waits_()) return;
    again_ = false;
    auto made = std::make_shared<Estimates>();
    launch(
        [made, work = work_, document = document_.document()](const Progress& progress) {
            work->document = document;
            DocumentResponses& responses = work->responses;
            for (const auto& [id, element] : work->document.elements) {
                if (progress.cancelled()) return;
                // An element without a joint face follows its bone rigidly: there is nothing to compute.
                if (element->faces.empty() || responses.freshOf(id)) continue;
                const ResponseEstimate e = responses.estimateOf(id);
                made->elements.emplace(id, StudioDocument::Estimate{element, e});
                ++made->precompute.elements;
                made->precompute.seconds += e.seconds;
                made->precompute.bytes = std::max(made->precompute.bytes, double(e.bytes));  // one after another
            }
            for (std::size_t k = 0; k < kEffects && !progress.cancelled(); ++k) made->effects[k] = effectCost(work->document, responses, EffectKind(k));
        },
        [this, made] {
            if (again_) return ask();
            latest_ = *made;
            document_.setEstimates(std::move(latest_->elements));
            Q_EMIT estimated();
        },
        [this] {
            if (again_) ask();
        });
}

}  // namespace imomushi
