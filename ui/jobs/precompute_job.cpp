// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/precompute_job.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <map>

#include "core/reduction/congruence.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"

namespace imomushi {

struct PrecomputeJob::Item {
    PartId element = 0;
    QString name;
    ResponseInput input;
    ContentKey key;
    double seconds = 0.0;  // estimated, by the thread
    // Taken over from a congruent element: an earlier item, or one that is known.
    std::shared_ptr<const Congruence> how;
    const Item* earlier = nullptr;
    std::shared_ptr<const ElementResponse> known;
    std::shared_ptr<const ElementResponse> response;
    Error error;
    std::atomic<bool> done{false};  // it stays as it is
};

struct PrecomputeJob::Work {
    std::deque<Item> items;  // stay where they are
    std::atomic<int> current{0};
    int threads = 1;
};

namespace {
// An element without a joint face follows its bone rigidly: there is nothing to compute.
bool needsPrecompute(StudioDocument& document, const Element& element) {
    return !element.faces.empty() && document.session().responseState(element.id) != ResponseState::Fresh;
}
}  // namespace

PrecomputeJob::PrecomputeJob(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {
    connect(this, &BackgroundJob::finished, this, [this](bool completed) {
        if (!completed) keep(*work_);
    });
    // What was precomputed is gone, as after undo: so is the work for it.
    connect(&document_, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (!change.has(&DocumentChange::elements)) return;
        const auto& elements = document_.document().elements;
        const auto wanted = [&](const Item& item) {
            const auto found = elements.find(item.element);
            return found != elements.end() && !found->second->faces.empty();
        };
        if (running() && std::none_of(work_->items.begin(), work_->items.end(), wanted)) cancel();
    });
}

bool PrecomputeJob::start() {
    if (running()) return true;
    auto work = std::make_shared<Work>();
    const Session& session = document_.session();
    std::map<PartId, const Item*> items;
    for (const auto& [id, element] : document_.document().elements) {
        if (!needsPrecompute(document_, *element)) continue;
        Item& item = work->items.emplace_back();
        item.element = id;
        item.name = QString::fromStdString(element->name);
        item.input = session.responseInput(id);
        items[id] = &item;
        // The one that is computed comes first in the document: it is an item already, or fresh.
        if (const auto* shared = session.sharedResponse(id)) {
            item.how = shared->how;
            if (const auto earlier = items.find(shared->from); earlier != items.end())
                item.earlier = earlier->second;
            else
                item.known = session.response(shared->from);
        }
    }
    if (work->items.empty()) return false;
    work->threads = session.responses().threads();
    work_ = work;
    launch(
        [work](const Progress& progress) {
            double total = 0.0, done = 0.0;
            for (Item& item : work->items) {
                if (progress.cancelled()) return;
                item.seconds = std::max(1e-3, item.how ? 0.0 : estimateResponse(item.input).seconds);
                total += item.seconds;
            }
            // What has no use for all threads is solved side by side first.
            std::vector<Item*> together;
            std::vector<ResponseInput> inputs;
            double sideBySide = 0.0;
            for (Item& item : work->items) {
                item.key = responseKey(item.input);
                if (item.how || !solvedBesideOthers(item.input)) continue;
                together.push_back(&item);
                inputs.push_back(item.input);
                sideBySide += item.seconds;
            }
            buildResponses(inputs, work->threads, [&](std::size_t i, Result<ElementResponse> response) {
                Item& item = *together[i];
                if (response) item.response = std::make_shared<const ElementResponse>(std::move(*response));
                else item.error = response.error();
                item.done = true;
            }, progress.part(0.0, sideBySide / total));
            done = sideBySide;
            for (std::size_t i = 0; i < work->items.size(); ++i) {
                Item& item = work->items[i];
                if (progress.cancelled()) return;
                if (item.done) continue;
                work->current = int(i);
                const auto first = item.earlier ? item.earlier->response : item.known;
                auto response = first                                 ? item.how->carry(*first)
                                : item.earlier ? Result<ElementResponse>(tl::unexpected(item.earlier->error))
                                               : buildResponse(item.input, progress.part(done / total, (done + item.seconds) / total));
                if (response) {
                    item.response = std::make_shared<const ElementResponse>(std::move(*response));
                } else {
                    item.error = response.error();
                }
                item.done = true;
                done += item.seconds;
                progress.report("", done / total);
            }
        },
        [this, work] { keep(*work); });
    return true;
}

void PrecomputeJob::keep(const Work& work) {
    std::vector<std::string> elements;
    for (const Item& item : work.items) {
        if (!item.done) continue;
        if (!item.response) {
            Q_EMIT elementFailed(item.name, errorText(item.error));
            continue;
        }
        document_.responses().insert(item.key, item.response, item.how != nullptr);
        // The command finds the result in the store; an element that changed meanwhile would be computed here and now: leave it.
        const auto& parts = document_.document().elements;
        const auto found = parts.find(item.element);
        if (found != parts.end() && responseKey(document_.session().responseInput(item.element)) == item.key) elements.push_back(found->second->name);
    }
    kept_ = int(elements.size());
    if (elements.empty()) return;
    Q_EMIT document_.responsesArriving();
    document_.execute(commands::precompute(elements));
}

QString PrecomputeJob::element() const {
    return work_ && !work_->items.empty() ? work_->items[std::size_t(work_->current.load())].name : QString();
}

}  // namespace imomushi
