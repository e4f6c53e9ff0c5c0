// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "core/body/body.h"
#include "core/commands/proposal_commands.h"
#include "core/io/character_file.h"
#include "core/session/session.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// A mesh file as a whole character, with a body for it.
struct PreparedCharacter {
    ImportRequest request;
    BodySetting setting;
    std::shared_ptr<const Result<CharacterFile>> file;
    std::shared_ptr<const Result<Body>> body;          ///< null where the file cannot be read
    std::optional<ProposalRequest> asked;              ///< how it is to be made soft, if anybody asked
    std::shared_ptr<const Result<Proposal>> proposal;  ///< null where nobody asked, or without a body
};

/// Reads one mesh file as a whole character in the background, makes its body, and proposes how to make it soft. A file that was read is not read again for another body, a body not made again for
/// another proposal.
class CharacterJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(const ImportRequest& request, const BodySetting& setting, const std::optional<ProposalRequest>& proposal);
    /// Of the last completed run; null before.
    [[nodiscard]] const std::shared_ptr<const PreparedCharacter>& result() const { return result_; }

private:
    std::shared_ptr<const PreparedCharacter> result_;
};

/// Lets a session take what was prepared instead of reading and making it again.
void usePrepared(Session& session, const std::shared_ptr<const PreparedCharacter>& made);

/// Whether two requests read the same.
bool sameFile(const ImportRequest& a, const ImportRequest& b);

}  // namespace imomushi
