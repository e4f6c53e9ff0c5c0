// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/character_job.h"

namespace imomushi {
namespace {

constexpr double kReading = 0.3;  // of the whole, as the command has it

}  // namespace

bool sameFile(const ImportRequest& a, const ImportRequest& b) { return a.path == b.path && a.unit == b.unit && a.up == b.up && a.bonesSuffice == b.bonesSuffice; }

void CharacterJob::start(const ImportRequest& request, const BodySetting& setting) {
    const auto known = result_ && result_->file && *result_->file && sameFile(result_->request, request) ? result_->file : nullptr;
    auto box = std::make_shared<PreparedCharacter>(PreparedCharacter{request, setting, known, nullptr});
    launch(
        [box](const Progress& progress) {
            if (!box->file) box->file = std::make_shared<const Result<CharacterFile>>(importCharacter(box->request, progress.part(0.0, kReading)));
            if (!*box->file) return;
            const RenderModel& model = (*box->file)->renderModel;
            box->body = std::make_shared<const Result<Body>>(makeBody(model.mesh.body, model.part, box->setting, progress.part(kReading, 1.0)));
        },
        [this, box] { result_ = box; });
}

}  // namespace imomushi
