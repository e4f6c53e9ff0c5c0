// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/character_job.h"

#include "core/document/character_source.h"

namespace imomushi {
namespace {

constexpr double kReading = 0.2, kBody = 0.7;  // of the whole

}  // namespace

bool sameFile(const ImportRequest& a, const ImportRequest& b) { return a.path == b.path && a.unit == b.unit && a.up == b.up && a.bonesSuffice == b.bonesSuffice; }

void usePrepared(Session& session, const std::shared_ptr<const PreparedCharacter>& made) {
    Services& services = session.services();
    services.importCharacter = [made](const ImportRequest& request, const Progress& progress) -> Result<CharacterFile> {
        return made->file && sameFile(made->request, request) ? *made->file : importCharacter(request, progress);
    };
    services.makeBody = [made](const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& progress) -> Result<Body> {
        if (made->body && made->setting == setting) return *made->body;
        return makeBody(model, rig, setting, progress);
    };
    services.propose = [made](const CharacterSource& character, const ProposalRequest& request, const Progress& progress) -> Result<Proposal> {
        return made->proposal && made->asked == request ? *made->proposal : proposeFor(character, request, progress);
    };
}

void CharacterJob::start(const ImportRequest& request, const BodySetting& setting, const std::optional<ProposalRequest>& proposal) {
    const auto known = result_ && result_->file && *result_->file && sameFile(result_->request, request) ? result_->file : nullptr;
    const auto sameBody = known && result_->body && result_->setting == setting ? result_->body : nullptr;
    const auto sameProposal = sameBody && proposal && result_->asked == proposal ? result_->proposal : nullptr;
    auto box = std::make_shared<PreparedCharacter>(PreparedCharacter{request, setting, known, sameBody, proposal, sameProposal});
    launch(
        [box](const Progress& progress) {
            if (!box->file) box->file = std::make_shared<const Result<CharacterFile>>(importCharacter(box->request, progress.part(0.0, kReading)));
            if (!*box->file) return;
            const RenderModel& model = (*box->file)->renderModel;
            if (!box->body) box->body = std::make_shared<const Result<Body>>(makeBody(model, (*box->file)->rig ? &*(*box->file)->rig : nullptr, box->setting, progress.part(kReading, kBody)));
            if (!box->asked || !*box->body || box->proposal) return;
            CharacterSource character;
            character.name = box->request.path.stem().string();
            character.model = {box->file, &model};
            character.body = {box->body, &**box->body};
            if ((*box->file)->rig) character.rig = {box->file, &*(*box->file)->rig};
            box->proposal = std::make_shared<const Result<Proposal>>(proposeFor(character, *box->asked, progress.part(kBody, 1.0)));
        },
        [this, box] { result_ = box; });
}

}  // namespace imomushi
