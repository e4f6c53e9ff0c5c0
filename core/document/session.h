// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/character/character.h"
#include "core/document/command.h"
#include "core/document/document.h"
#include "core/io/import.h"
#include "core/reduction/element_response.h"

namespace imomushi {

struct Congruence;
struct Project;

/// Precomputed responses by content key, shared by everything in a session. Never undone; undo only asks for another key. Thread-safe.
class ResponseCache {
public:
    [[nodiscard]] std::shared_ptr<const ElementResponse> find(const ContentKey& key) const;
    void insert(const ContentKey& key, std::shared_ptr<const ElementResponse> response);
    [[nodiscard]] std::vector<std::pair<ContentKey, std::shared_ptr<const ElementResponse>>> all() const;
    /// Rises with every insert().
    [[nodiscard]] std::uint64_t revision() const;

private:
    mutable std::mutex mutex_;
    std::map<ContentKey, std::shared_ptr<const ElementResponse>> responses_;
    std::atomic<std::uint64_t> revision_ = 0;
};

/// What an effect will cost on this machine: predicted before precompute.
struct EffectCost {
    int columns = 0;            ///< of A' that it adds, all elements together
    std::size_t bytes = 0;      ///< that a frame reads for it
    double milliseconds = 0.0;  ///< per frame
    double seconds = 0.0;       ///< of the precompute that it waits for
    bool precompute = false;    ///< an element must be precomputed for it first
};

/// A document that is being worked on, with its history, its responses and its live character: the one door for change.
class Session {
public:
    /// `registry` must outlive the session.
    explicit Session(const CommandRegistry& registry);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Runs one command: {"do": name, key: value, ...}. Checks names, types and finiteness of every key first; on an error the document
    /// is as it was. Errors: "unknown-command", "unknown-key", "missing-key", "bad-type", "not-finite", and the command's own.
    Result<Json> execute(const Json& command, const Progress& progress = {});

    [[nodiscard]] const Document& document() const;
    [[nodiscard]] const CommandRegistry& registry() const;
    [[nodiscard]] ResponseCache& responses();

    // ---- history -------------------------------------------------------------------------------------------------
    struct Step {
        std::string name;     ///< of the command ("add-bone"), for display through tr()
        std::string subject;  ///< what it was done to
    };
    [[nodiscard]] const std::vector<Step>& steps() const;  ///< all, oldest first
    [[nodiscard]] int position() const;                    ///< how many of them are done; the rest can be redone
    /// Commands between begin and end become one undo step (a drag gesture). cancelGesture() takes them back.
    void beginGesture();
    void endGesture();
    void cancelGesture();
    /// Differs from what was last saved or opened.
    [[nodiscard]] bool modified() const;
    [[nodiscard]] const std::filesystem::path& path() const;  ///< of the project file, empty: never saved

    // ---- live ----------------------------------------------------------------------------------------------------
    /// The character of the document as it is now, rebuilt lazily after structural changes; null while there are no elements.
    /// Elements without a fresh response follow their bones rigidly (or with their last response where it still fits).
    Character* character();
    [[nodiscard]] int elementIndex(PartId element) const;      ///< in character(), -1: none
    [[nodiscard]] int pointIndex(const EndpointRef& end) const;  ///< joint point in the skeleton, -1: none
    /// The pose that the character shows: the document's, or where effects have taken it, or that of a take. Empty: at rest.
    const Pose& shownPose();
    /// Something goes on by itself: frames must be stepped to see it.
    bool moving();
    /// Advances glides, poses and effects by one frame and updates the character. What "step" does `frames` times.
    void stepFrame(double dt);

    /// What is being recorded (the command "record"); none: nothing.
    struct Recording {
        std::string take;
        std::size_t frames = 0;
        double seconds = 0.0;
    };
    [[nodiscard]] std::optional<Recording> recording() const;
    /// A take is what is seen (the command "play"), not the pose of the document.
    [[nodiscard]] bool showsTake() const;

    /// Milliseconds that an effect took in the last frame; none: the frame did without it.
    [[nodiscard]] std::optional<double> effectMilliseconds(EffectKind effect) const;
    /// What it costs to have an effect, on or off now.
    [[nodiscard]] EffectCost effectCost(EffectKind effect) const;

    enum class ResponseState { None, Fresh, Stale };
    [[nodiscard]] ResponseState responseState(PartId element) const;
    /// What a precompute of this element would take as input (for jobs in the background).
    [[nodiscard]] ResponseInput responseInput(PartId element) const;
    /// Of congruent elements only the first of the document is computed; the others take its response over, turned. By the document alone, whatever is
    /// known already, so that a script gives the same bytes each time. Null: the element is computed itself. Valid until the document changes.
    struct SharedResponse {
        PartId from = 0;
        std::shared_ptr<const Congruence> how;
    };
    [[nodiscard]] const SharedResponse* sharedResponse(PartId element) const;
    /// The fresh response, null: none.
    [[nodiscard]] std::shared_ptr<const ElementResponse> response(PartId element) const;
    /// What precomputing this element costs, known already or not; where it is shared, without what it is shared from. Remembered until the element changes.
    [[nodiscard]] ResponseEstimate responseEstimate(PartId element) const;

    // ---- for studio and recovery -----------------------------------------------------------------------------------
    /// Called after each change, on the caller's thread.
    struct Change {
        bool structure = false;  ///< elements, faces, joints, bones, settings
        bool pose = false;
        bool responses = false;
        bool file = false;       ///< path or saved state
    };
    void setListener(std::function<void(const Change&)> listener);
    /// Replaces importFile() (the studio imports in the background and answers from what it prepared).
    void setImporter(std::function<Result<ImportResult>(const ImportRequest&, const Progress&)> importer);
    /// What "save" writes, and an autosave: the document as it is now with the responses that its elements have. Copies no mesh and no response.
    [[nodiscard]] Project project();
    /// Every document-changing command of this session so far, as script lines, with the frames that its takes are made of: what "Save as script" writes.
    [[nodiscard]] const std::vector<Json>& script() const;

    // ---- for commands only -------------------------------------------------------------------------------------------
    /// The document to change inside Command::run; what it was goes on the undo stack when the command succeeds.
    Document& edit();
    struct State;
    State& state();

private:
    std::unique_ptr<State> state_;
};

}  // namespace imomushi
