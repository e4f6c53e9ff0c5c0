// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/proposal_request.h"

#include "core/document/character_source.h"
#include "core/proposal/rig_proposal.h"
#include "core/proposal/shape_proposal.h"

namespace imomushi {

Result<Proposal> proposeFor(const CharacterSource& character, const ProposalRequest& request, const Progress& progress) {
    using From = ProposalRequest::From;
    if (character.rig && !character.rig->bones.empty() && request.from != From::Shape) {
        std::optional<std::vector<int>> chosen;
        if (request.bones) {
            chosen.emplace();
            for (const std::string& name : *request.bones) {
                chosen->push_back(character.rig->boneIndex(name));
                if (chosen->back() < 0) return fail("no-such-bone", "The skeleton of \"" + character.name + "\" has no bone \"" + name + "\".");
            }
        }
        auto proposal = proposeFromRig(*character.rig, character.model->mesh.body, character.body->mesh, request.least < 0.0 ? std::nullopt : std::optional(request.least), progress, chosen);
        // A skeleton that divides nothing is no reason to leave a shape whole.
        if (!proposal || !proposal->cuts.empty() || request.from == From::Skeleton) return proposal;
    }
    if (request.from == From::Skeleton)
        return fail("no-skeleton", "The character \"" + character.name + "\" came without a skeleton: import one, or propose from its \"shape\".");
    return proposeFromShape(character.body->mesh, request.least < 0.0 ? kLeastShare : request.least, progress);
}

}  // namespace imomushi
