// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/commands/proposal_commands.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// Finds in the background which bones of a character's file would stay and which would be merged.
class BonesJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    /// `character`: with a rig.
    void start(std::shared_ptr<const CharacterSource> character);
    [[nodiscard]] const std::shared_ptr<const CharacterSource>& character() const { return character_; }
    /// Of the last completed run.
    [[nodiscard]] const Result<Proposal>& proposal() const { return *proposal_; }

private:
    std::shared_ptr<const CharacterSource> character_;
    std::shared_ptr<const Result<Proposal>> proposal_;
};

}  // namespace imomushi
