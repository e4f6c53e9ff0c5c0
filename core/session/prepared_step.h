// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/document/command.h"
#include "core/document/document.h"
#include "core/document/document_history.h"
#include "core/project/document_responses.h"
#include "core/project/project_file.h"
#include "core/project/stored_response.h"

namespace imomushi {

struct BuiltCharacter;
class Session;

/// Commands that were executed on a copy of a document, as one step, for Session::takePrepared(): slow commands need not hold up whoever shows the document.
struct PreparedStep {
    Document before, after;
    DocumentHistory::Step step;
    std::vector<Json> lines;  ///< of the script, not empty
    Json answer;              ///< of the last command
    std::vector<std::pair<PartId, StoredResponse>> responses;  ///< that elements got by it: what is moved or copied keeps its results
    DocumentResponses::Derived derived;               ///< from `after`
    std::shared_ptr<const BuiltCharacter> character;  ///< of `after`, null: it cannot be built

    /// What the commands found is still so: the document differs from `before` in its pose at most, which passes with time.
    [[nodiscard]] bool fits(const Document& document) const;
};

/// Executes commands in a session of its own: one that makes one step of the history, or several that change the document. Any thread may call it; meshes and responses of `project` are
/// shared, nothing of it changes. `arrange`: sets what the session is to take instead of reading files and the like; may be empty. Errors: those of the commands.
Result<PreparedStep> prepareStep(const CommandRegistry& registry, Project project, const std::vector<Json>& commands, const std::function<void(Session&)>& arrange, const Progress& progress);

/// The character of a project, built beside a session that opens it. Any thread may call it. Null: there is none, or it cannot be built.
std::shared_ptr<const BuiltCharacter> buildCharacter(const CommandRegistry& registry, Project project);

}  // namespace imomushi
