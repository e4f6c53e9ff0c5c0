// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/document/document.h"
#include "core/proposal/proposal.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// Asks in the background how a character of the document would be made soft, as propose does.
class ProposalJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(std::shared_ptr<const CharacterSource> character);
    /// Of the last run that was started.
    [[nodiscard]] const std::shared_ptr<const CharacterSource>& character() const { return character_; }
    /// Of the last completed run; null before.
    [[nodiscard]] const std::shared_ptr<const Result<Proposal>>& result() const { return result_; }

private:
    std::shared_ptr<const CharacterSource> character_;
    std::shared_ptr<const Result<Proposal>> result_;
};

}  // namespace imomushi
