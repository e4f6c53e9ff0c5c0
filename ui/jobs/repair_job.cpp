// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/repair_job.h"

namespace imomushi {

bool MadeBody::isOf(const RenderModel& model, const BodySetting& asked) const {
    const TriangleMesh& mesh = model.mesh.body;
    return setting == asked && mesh.vertices.rows() == vertices.rows() && mesh.triangles.rows() == triangles.rows() &&
           mesh.vertices == vertices && mesh.triangles == triangles;
}

void RepairJob::start(const Document& document, const Json& repair) {
    auto made = std::make_shared<std::vector<MadeBody>>();
    auto work = mendWork(document, repair);
    launch(
        [made, work = work ? std::move(*work) : MendWork()](const Progress& progress) {
            if (!work) return;  // the command says what is wrong with it
            const BodyMaker maker = [&made](const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& part) {
                Result<Body> body = makeBody(model, rig, setting, part);
                if (body) made->push_back({setting, model.mesh.body.vertices, model.mesh.body.triangles, *body});
                return body;
            };
            work(maker, progress);
        },
        [this, made] { bodies_ = made; });
}

}  // namespace imomushi
