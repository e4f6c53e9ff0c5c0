// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/bones_job.h"

#include <memory>
#include <utility>

namespace imomushi {

void BonesJob::start(std::shared_ptr<const CharacterSource> character) {
    character_ = std::move(character);
    auto box = std::make_shared<std::shared_ptr<const Result<Proposal>>>();
    launch([box, of = character_](const Progress& progress) { *box = std::make_shared<const Result<Proposal>>(proposeFor(*of, {ProposalRequest::From::Skeleton, -1.0, {}}, progress)); },
           [this, box] { proposal_ = *box; });
}

}  // namespace imomushi
