// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/precompute_job.h"

#include <algorithm>
#include <atomic>

#include "ui/models/texts.h"

namespace imomushi {

struct PrecomputeJob::Item {
    PartId element = 0;
    QString name;
    ResponseInput input;
    ContentKey key;
    double seconds = 0.0;  // estimated
    std::shared_ptr<const ElementResponse> response;
    Error error;
};

struct PrecomputeJob::Work {
    std::vector<Item> items;
    std::atomic<int> current{0};
};

namespace {
// An element without a joint face follows its bone rigidly: there is nothing to compute.
bool needsPrecompute(StudioDocument& document, const Element& element) {
    return !element.faces.empty() && document.session().responseState(element.id) != Session::ResponseState::Fresh;
}
}  // namespace

PrecomputeJob::PrecomputeJob(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {}

PrecomputeEstimate PrecomputeJob::estimate() const {
    PrecomputeEstimate sum;
    for (const auto& [id, element] : document_.document().elements) {
        if (!needsPrecompute(document_, *element)) continue;
        const ResponseEstimate e = estimateResponse(document_.session().responseInput(id));
        ++sum.elements;
        sum.seconds += e.seconds;
        sum.bytes += double(e.bytes);
    }
    return sum;
}

bool PrecomputeJob::start() {
    if (running()) return true;
    auto work = std::make_shared<Work>();
    for (const auto& [id, element] : document_.document().elements) {
        if (!needsPrecompute(document_, *element)) continue;
        Item item;
        item.element = id;
        item.name = QString::fromStdString(element->name);
        item.input = document_.session().responseInput(id);
        item.seconds = std::max(1e-3, estimateResponse(item.input).seconds);
        work->items.push_back(std::move(item));
    }
    if (work->items.empty()) return false;
    work_ = work;
    launch(
        [work](const Progress& progress) {
            double total = 0.0, done = 0.0;
            for (const Item& item : work->items) total += item.seconds;
            for (std::size_t i = 0; i < work->items.size(); ++i) {
                Item& item = work->items[i];
                work->current = int(i);
                if (progress.cancelled()) return;
                item.key = responseKey(item.input);
                auto response = buildResponse(item.input, progress.part(done / total, (done + item.seconds) / total));
                if (response) {
                    item.response = std::make_shared<const ElementResponse>(std::move(*response));
                } else {
                    item.error = response.error();
                }
                done += item.seconds;
                progress.report("", done / total);
            }
        },
        [this, work] {
            Json elements = Json::array();
            for (const Item& item : work->items) {
                if (!item.response) {
                    Q_EMIT elementFailed(item.name, errorText(item.error));
                    continue;
                }
                document_.session().responses().insert(item.key, item.response);
                // The command finds the result in the cache; an element that changed meanwhile would be computed here and now: leave it.
                const auto& parts = document_.document().elements;
                const auto found = parts.find(item.element);
                if (found != parts.end() && responseKey(document_.session().responseInput(item.element)) == item.key)
                    elements.push_back(found->second->name);
            }
            if (!elements.empty()) document_.execute({{"do", "precompute"}, {"elements", elements}});
        });
    return true;
}

QString PrecomputeJob::element() const {
    return work_ && !work_->items.empty() ? work_->items[std::size_t(work_->current.load())].name : QString();
}

}  // namespace imomushi
