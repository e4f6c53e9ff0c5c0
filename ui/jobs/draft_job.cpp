// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/draft_job.h"

#include <algorithm>

namespace imomushi {

struct DraftJob::Work {
    PartId element = 0;
    ResponseInput input;
    ContentKey key, shape;
    std::shared_ptr<const ElementResponse> response;  // null: it could not be solved
};

DraftJob::DraftJob(StudioDocument& document, QObject* parent) : BackgroundJob(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, &DraftJob::follow);
}

void DraftJob::follow(const DocumentChange& change) {
    const auto& elements = document_.document().elements;
    bool wanted = false;
    for (const auto& [id, was] : change.elements) {
        const auto now = elements.find(id);
        // Elements that come with their handles come with their responses, or were never precomputed by choice.
        if (!was || now == elements.end() || was->handles == now->second->handles) continue;
        if (std::find(waiting_.begin(), waiting_.end(), id) == waiting_.end()) waiting_.push_back(id);
        if (work_ && work_->element == id && running()) cancel();
        wanted = true;
    }
    if (wanted && !running()) next();
}

void DraftJob::next() {
    Session& session = document_.session();
    while (!waiting_.empty()) {
        const PartId id = waiting_.front();
        waiting_.erase(waiting_.begin());
        const auto element = document_.document().elements.find(id);
        if (element == document_.document().elements.end() || element->second->faces.empty()) continue;
        if (session.responseState(id) == Session::ResponseState::Fresh || session.responses().fittingOf(id)) continue;
        const auto vertices = element->second->mesh->body.vertices.rows();
        if (vertices > kLargest) continue;
        auto work = std::make_shared<Work>();
        work->element = id;
        work->input = session.responseInput(id);
        work->shape = session.responses().shapeOf(id);
        work->input.solverMesh = vertices > 2 * kVertices ? SolverMeshSetting{SolverMeshSetting::Kind::Decimated, kVertices} : SolverMeshSetting{SolverMeshSetting::Kind::AsIs};
        work_ = work;
        launch(
            [work](const Progress& progress) {
                work->key = responseKey(work->input);
                if (auto made = buildResponse(work->input, progress)) work->response = std::make_shared<const ElementResponse>(std::move(*made));
            },
            [this, work] {
                Session& of = document_.session();
                if (work->response && document_.document().elements.contains(work->element) && of.responses().shapeOf(work->element) == work->shape &&
                    of.responseState(work->element) != Session::ResponseState::Fresh) {
                    of.responses().bring(work->element, {work->key, work->shape, work->response});
                    Q_EMIT document_.responsesChanged();
                    Q_EMIT document_.poseChanged();
                }
                next();
            });
        return;
    }
    Q_EMIT drafted();
}

}  // namespace imomushi
