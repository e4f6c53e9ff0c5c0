// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/proposal/proposal.h"

namespace imomushi {

struct CharacterSource;

/// How a character is to be proposed for.
struct ProposalRequest {
    enum class From { Auto, Skeleton, Shape } from = From::Auto;
    double least = -1.0;  ///< smallest share of the flesh of a piece, 0...1; negative: as is usual
    std::optional<std::vector<std::string>> bones;  ///< of the file's skeleton, that stay; none: those that move enough flesh
    bool operator==(const ProposalRequest&) const = default;
};

/// Proposes for a character. Auto: from its skeleton, if its file brought one, else from its shape. Errors: those of proposeFromShape(), "no-skeleton", "no-such-bone".
Result<Proposal> proposeFor(const CharacterSource& character, const ProposalRequest& request, const Progress& progress);

}  // namespace imomushi
