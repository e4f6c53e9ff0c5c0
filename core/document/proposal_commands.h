// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/proposal/proposal.h"
#include "core/document/command.h"
#include "core/document/document.h"

namespace imomushi {

/// What "from" and "least" ask for. Errors: "bad-value".
struct ProposalRequest {
    enum class From { Auto, Skeleton, Shape } from = From::Auto;
    double least = -1.0;  ///< smallest share of the flesh of a piece, 0...1; negative: as is usual
};
Result<ProposalRequest> proposalRequestFrom(const Json& arguments);

/// Proposes for a character. Auto: from its skeleton, if its file brought one, else from its shape. Errors: those of proposeFromShape(), "no-skeleton".
Result<Proposal> proposeFor(const CharacterSource& character, const ProposalRequest& request, const Progress& progress);

/// {"from", "root", "cuts", "bones", "pins", "handles", "parts", "merged", "notes", "symmetry"}.
Json proposalJson(const CharacterSource& character, const Proposal& proposal);

/// The same back: "root", "cuts", "bones", "pins", "handles" and "parts" of what propose answered, changed or not; lists may be missing, other keys are not read. A bone hangs on the
/// end of its parent unless it starts where that starts. Errors: "bad-proposal", "no-such-part".
Result<Proposal> proposalFrom(const CharacterSource& character, const Json& json);

/// The size of a character, and a unit if its size cannot be meant: {"height", "diagonal", "suggested_unit", "note"}, metres.
Json sizeJson(const CharacterSource& character);

}  // namespace imomushi
