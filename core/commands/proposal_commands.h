// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"
#include "core/session/proposal_request.h"

namespace imomushi {

/// What "from", "least" and "bones" ask for. Errors: "bad-value", "bad-type".
Result<ProposalRequest> proposalRequestFrom(const Json& arguments);

/// What make-soft and propose begin with: a character without cuts, bones and handles, or an element of its own without joint faces, handles and bones.
[[nodiscard]] bool canBecomeSoft(const Document& document, const CharacterSource& character);
[[nodiscard]] bool canBecomeSoft(const Document& document, const Element& element);

/// {"from", "root", "cuts", "bones", "pins", "handles", "parts", "merged", "notes", "symmetry"}.
Json proposalJson(const CharacterSource& character, const Proposal& proposal);

/// A size that cannot be meant, and the unit in which it can be.
struct SizeDoubt {
    double size = 0.0;     ///< m, the longest side of the box as it is
    std::string unit;      ///< "cm" or "mm"; empty: none makes a usual size of it
    double meant = 0.0;    ///< m, in that unit
};
/// None: the size can be meant. `vertices`: of what is seen, m.
std::optional<SizeDoubt> doubtedSize(const Points& vertices);

/// The same back: "root", "cuts", "bones", "pins", "handles" and "parts" of what propose answered, changed or not; lists may be missing, other keys are not read. A bone hangs on the
/// end of its parent unless it starts where that starts. Errors: "bad-proposal", "no-such-part".
Result<Proposal> proposalFrom(const CharacterSource& character, const Json& json);

/// The size of a character, and a unit if its size cannot be meant: {"height", "diagonal", "suggested_unit", "note"}, metres.
Json sizeJson(const CharacterSource& character);

}  // namespace imomushi
