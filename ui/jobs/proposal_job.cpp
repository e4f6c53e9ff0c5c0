// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/proposal_job.h"

#include "core/commands/proposal_commands.h"

namespace imomushi {

void ProposalJob::start(std::shared_ptr<const CharacterSource> character) {
    character_ = std::move(character);
    auto made = std::make_shared<std::shared_ptr<const Result<Proposal>>>();
    launch([made, of = character_](const Progress& progress) { *made = std::make_shared<const Result<Proposal>>(proposeFor(*of, {}, progress)); }, [this, made] { result_ = *made; });
}

}  // namespace imomushi
