// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/draft_job.h"

namespace imomushi {

/// A plane that is dragged changes the document in every frame: what follows another change within this time waits as long.
static constexpr int kSoonMs = 80;

struct DraftJob::Work {
    PartId element = 0;
    ResponseInput input;
    ContentKey key, shape;
    std::shared_ptr<const ElementResponse> response;  // null: it could not be solved
};

DraftJob::DraftJob(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, &DraftJob::follow);
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
    const auto& responses = document_.session().responses();
    if (running() && !(document_.document().elements.contains(work_->element) && responses.shapeOf(work_->element) == work_->shape)) cancel();
    const bool follows = changed_.isValid() && changed_.elapsed() < kSoonMs;
    changed_.start();
    soon_.start(follows ? kSoonMs : 0);
}

bool DraftJob::wants(PartId id) const {
    const auto element = document_.document().elements.find(id);
    if (element == document_.document().elements.end() || element->second->faces.empty() || element->second->mesh->body.vertices.rows() > kLargest) return false;
    const auto& responses = document_.session().responses();
    return !responses.fittingOf(id) && !failed_.contains(responses.shapeOf(id));
}

void DraftJob::start() {
    waiting_.clear();
    for (const auto& [id, element] : document_.document().elements)
        if (wants(id)) waiting_.push_back(id);
    if (running()) return;  // next() goes on
    if (!waiting_.empty()) {
        told_ = true;
        Q_EMIT drafting();
    } else if (!told_) {
        return;
    }
    next();
}

void DraftJob::next() {
    Session& session = document_.session();
    while (!waiting_.empty()) {
        const PartId id = waiting_.front();
        waiting_.pop_front();
        if (!wants(id)) continue;
        auto work = std::make_shared<Work>();
        work->element = id;
        work->input = session.responses().inputOfDraft(id);
        work->key = responseKey(work->input);
        work->shape = session.responses().shapeOf(id);
        // Undo, and a handle that passes, lead back to what had one before.
        if (auto known = session.responses().store().find(work->key)) {
            bring(id, {work->key, work->shape, std::move(known)});
            if (!wants(id)) continue;
        }
        work_ = work;
        launch(
            [work](const Progress& progress) {
                if (auto made = buildResponse(work->input, progress)) work->response = std::make_shared<const ElementResponse>(std::move(*made));
            },
            [this, work] {
                if (work->response)
                    bring(work->element, {work->key, work->shape, work->response});
                else
                    failed_.insert(work->shape);
                next();
            });
        return;
    }
    told_ = false;
    Q_EMIT drafted();
}

void DraftJob::bring(PartId element, const StoredResponse& response) {
    DocumentResponses& responses = document_.session().responses();
    if (!document_.document().elements.contains(element) || responses.shapeOf(element) != response.shape || responses.fittingOf(element)) return;
    Q_EMIT document_.responsesArriving();
    responses.bring(element, response);
    Q_EMIT document_.responsesChanged();
    Q_EMIT document_.poseChanged();
}

}  // namespace imomushi
