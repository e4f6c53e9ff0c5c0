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
#include "core/project/project_file.h"
#include "core/project/stored_response.h"

namespace imomushi {

struct BuiltCharacter;
class Session;

/// A command that was executed on a copy of a document, for Session::execute() to take over: slow commands need not hold up whoever shows the document.
struct PreparedStep {
    Json command;
    Document before, after;
    DocumentHistory::Step step;
    std::vector<Json> lines;  ///< of the script, not empty
    Json answer;
    std::vector<std::pair<PartId, StoredResponse>> responses;  ///< that elements got by it: what is moved or copied keeps its results
    std::shared_ptr<const BuiltCharacter> character;  ///< of `after`, null: it cannot be built

    /// What the command found is still so: the document differs from `before` in its pose at most, which passes with time.
    [[nodiscard]] bool fits(const Document& document) const;
};

/// Executes a command that makes one step of the history, in a session of its own. Any thread may call it; meshes and responses of `project` are shared, nothing of it changes.
/// `arrange`: sets what the session is to take instead of reading files and the like; may be empty. Errors: the command's own.
Result<PreparedStep> prepareStep(const CommandRegistry& registry, Project project, const Json& command, const std::function<void(Session&)>& arrange, const Progress& progress);

/// The character of a project, built beside a session that opens it. Any thread may call it. Null: there is none, or it cannot be built.
std::shared_ptr<const BuiltCharacter> buildCharacter(const CommandRegistry& registry, Project project);

}  // namespace imomushi
