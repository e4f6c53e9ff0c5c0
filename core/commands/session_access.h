// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "core/commands/session.h"
#include "core/live/live_character.h"
#include "core/project/project_file.h"

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

    // ---- what a command did, for the listener
    void changedPose() { session.told_.pose = true; }
    void changedResponses() { session.told_.responses = true; }

    // ---- history
    /// A line that belongs into the script without being a step.
    void note(const Json& line) { session.history_.note(line); }
    /// False: in a gesture it takes back that, which is no step. Errors: "nothing-to-undo".
    Result<bool> undo(int count);
    /// Ends a gesture. Errors: "nothing-to-redo".
    Result<bool> redo(int count);
    /// Makes a take that was recorded a part of the document, as one step of its own, in the middle of a gesture too. `line`: the command, for the script.
    std::shared_ptr<const Take> addTake(Take take, const Json& line);
    /// Other commands as one step, which is a gesture: begin, execute(), end. A gesture that goes on ends first.
    void beginStep() { session.beginGesture(); }
    Result<Json> execute(const Json& command, const Progress& progress) { return session.execute(command, progress); }
    void endStep(DocumentHistory::Step step);
    /// Takes back what was executed since beginStep().
    void cancelStep() noexcept { session.cancelGesture(); }

    // ---- file
    [[nodiscard]] Result<SavedProject> write(const std::filesystem::path& path) const { return session.services_.write(path, session.project(), session.versions_); }
    /// Replaces everything by another project; see DocumentHistory::replace().
    void replace(Project project, std::filesystem::path path, bool saved, const Json& line);
    void markSaved(const std::filesystem::path& path);
};

}  // namespace imomushi
