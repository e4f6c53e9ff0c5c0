// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "core/live/live_character.h"
#include "core/project/project_file.h"
#include "core/session/session.h"

namespace imomushi {

/// What Command::run may do. The parts of the document are out of its reach but for whole steps: undo, redo, another document, a take that was recorded.
class SessionAccess {
public:
    explicit SessionAccess(Session& owner);

    Session& session;  ///< for questions
    [[nodiscard]] const Document& document() const { return session.document(); }
    LiveCharacter& live;
    DocumentResponses& responses;
    const Services& services;

    // ---- what the listener is told when the command has ended
    void changedPose() { session.pendingChange_.pose = true; }
    void changedResponses() { session.pendingChange_.responses = true; }

    // ---- history
    /// Adds a line to the script that makes no undo step.
    void note(const Json& line) { session.history_.note(line); }
    /// Within a gesture it cancels the gesture instead, and returns false: no step was undone. Errors: "nothing-to-undo".
    Result<bool> undo(int count);
    /// Ends a gesture first. Errors: "nothing-to-redo".
    Result<bool> redo(int count);
    /// Adds a recorded take to the document, as one step of its own even within a gesture. `line`: the command, for the script.
    std::shared_ptr<const Take> addTake(Take take, const Json& line);
    /// beginStep(), execute() and endStep() make several commands one undo step. They are a gesture; one that is open ends first.
    void beginStep() { session.beginGesture(); }
    Result<Json> execute(const Json& command, const Progress& progress) { return session.execute(command, progress); }
    void endStep(DocumentHistory::Step step);
    /// Undoes what was executed since beginStep().
    void cancelStep() noexcept { session.cancelGesture(); }

    // ---- file
    [[nodiscard]] Result<SavedProject> write(const std::filesystem::path& path) const { return session.services_.write(path, session.project(), session.versions_); }
    /// Replaces everything by another project; see DocumentHistory::replace().
    void replace(Project project, std::filesystem::path path, bool saved, const Json& line);
    void markSaved(const std::filesystem::path& path);
};

}  // namespace imomushi
