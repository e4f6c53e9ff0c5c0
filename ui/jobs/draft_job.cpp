// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/draft_job.h"

#include <algorithm>
#include <atomic>
#include <deque>

namespace imomushi {

/// A plane that is dragged changes the document in every frame: what follows another change within this time waits as long.
static constexpr int kSoonMs = 80;

struct DraftJob::Work {
    struct Item {
        PartId element = 0;
        ResponseInput input;
        ContentKey key, shape;
        std::shared_ptr<const ElementResponse> response;  // null: it could not be solved
        std::atomic<bool> done{false};                    // it stays as it is
        bool taken = false;                               // by the window
    };
    std::deque<Item> items;  // stay where they are
    int threads = 1;
};

DraftJob::DraftJob(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.forResponses()) follow();
    });
    soon_.setSingleShot(true);
    connect(&soon_, &QTimer::timeout, this, &DraftJob::start);
}

void DraftJob::setEnabled(bool on) {
    enabled_ = on;
    if (on) {
        follow();
    } else {
        soon_.stop();
        cancel();
    }
}

void DraftJob::follow() {
    if (!enabled_) return;
    if (running()) {
        takeDone();
        const auto& parts = document_.document().elements;
        const auto& responses = document_.session().responses();
        const auto asked = [&](const Work::Item& item) { return item.taken || (parts.contains(item.element) && responses.shapeOf(item.element) == item.shape); };
        if (!std::all_of(work_->items.begin(), work_->items.end(), asked)) cancel();
    }
    const bool follows = changed_.isValid() && changed_.elapsed() < kSoonMs;
    changed_.start();
    soon_.start(follows ? kSoonMs : 0);
}

bool DraftJob::wants(PartId id) const {
    const auto element = document_.document().elements.find(id);
    if (element == document_.document().elements.end() || element->second->faces.empty() || element->second->mesh->body.vertices.rows() > kLargest) return false;
    const auto& responses = document_.session().responses();
    return (!responses.fittingOf(id) || responses.lacksPatches(id)) && !failed_.contains(responses.shapeOf(id));
}

void DraftJob::start() {
    if (running()) return;  // asks again when it is done
    DocumentResponses& responses = document_.responses();
    auto work = std::make_shared<Work>();
    std::vector<std::pair<PartId, StoredResponse>> known;
    for (const auto& [id, element] : document_.document().elements) {
        if (!wants(id)) continue;
        ResponseInput input = responses.inputOfDraft(id);
        const ContentKey key = responseKey(input), shape = responses.shapeOf(id);
        // Undo, and a handle that passes, lead back to what had one before.
        if (auto response = responses.store().find(key)) {
            known.emplace_back(id, StoredResponse{key, shape, std::move(response)});
            continue;
        }
        Work::Item& item = work->items.emplace_back();
        item.element = id;
        item.input = std::move(input);
        item.key = key;
        item.shape = shape;
    }
    if (!draftingTold_ && (!known.empty() || !work->items.empty())) {
        draftingTold_ = true;
        Q_EMIT drafting();
    }
    bring(known);
    if (work->items.empty()) {
        if (std::exchange(draftingTold_, false)) Q_EMIT drafted();
        return;
    }
    work->threads = responses.threads();
    work_ = work;
    launch(
        [work](const Progress& progress) {
            std::vector<ResponseInput> inputs;
            for (const Work::Item& item : work->items) inputs.push_back(item.input);
            buildResponses(inputs, work->threads, [&](std::size_t i, Result<ElementResponse> made) {
                Work::Item& item = work->items[i];
                if (made) item.response = std::make_shared<const ElementResponse>(std::move(*made));
                item.done = true;
            }, progress);
        },
        [this] {
            takeDone();
            start();
        },
        [this] {
            takeDone();
            for (const Work::Item& item : work_->items)
                if (!item.taken) failed_.insert(item.shape);  // not again and again
            start();
        });
}

void DraftJob::takeDone() {
    std::vector<std::pair<PartId, StoredResponse>> made;
    for (Work::Item& item : work_->items) {
        if (item.taken || !item.done) continue;
        item.taken = true;
        if (item.response) made.emplace_back(item.element, StoredResponse{item.key, item.shape, item.response});
        else failed_.insert(item.shape);
    }
    bring(made);
}

void DraftJob::bring(const std::vector<std::pair<PartId, StoredResponse>>& made) {
    DocumentResponses& responses = document_.responses();
    std::vector<std::pair<PartId, StoredResponse>> fitting;
    for (const auto& one : made)
        if (document_.document().elements.contains(one.first) && responses.shapeOf(one.first) == one.second.shape && (!responses.fittingOf(one.first) || responses.lacksPatches(one.first))) fitting.push_back(one);
    if (fitting.empty()) return;
    Q_EMIT document_.responsesArriving();
    for (const auto& [element, response] : fitting) {
        responses.bring(element, response);
        if (responses.lacksPatches(element)) failed_.insert(response.shape);  // a body without room for patches
    }
    Q_EMIT document_.responsesChanged();
    Q_EMIT document_.poseChanged();
}

}  // namespace imomushi
