// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "core/body/body.h"
#include "core/proposal/proposal.h"
#include "core/io/character_file.h"
#include "ui/jobs/background_job.h"

namespace imomushi {

/// A mesh file as a whole character, with a body for it.
struct PreparedCharacter {
    ImportRequest request;
    BodySetting setting;
    std::shared_ptr<const Result<CharacterFile>> file;
    std::shared_ptr<const Result<Body>> body;          ///< null where the file cannot be read
    std::shared_ptr<const Result<Proposal>> proposal;  ///< how it would be made soft; null where nobody asked, or without a body
};

/// Reads one mesh file as a whole character in the background, makes its body, and proposes how to make it soft. A file that was read is not read again for another body.
class CharacterJob : public BackgroundJob {
    Q_OBJECT
public:
    using BackgroundJob::BackgroundJob;
    void start(const ImportRequest& request, const BodySetting& setting, bool propose);
    /// Of the last completed run; null before.
    [[nodiscard]] const std::shared_ptr<const PreparedCharacter>& result() const { return result_; }

private:
    std::shared_ptr<const PreparedCharacter> result_;
};

/// Whether two requests read the same.
bool sameFile(const ImportRequest& a, const ImportRequest& b);

}  // namespace imomushi
