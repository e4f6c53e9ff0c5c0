// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/character/character.h"
#include "core/document/command.h"
#include "core/document/document.h"
#include "core/document/document_history.h"
#include "core/live/live_input.h"
#include "core/project/document_responses.h"
#include "core/project/project_versions.h"
#include "core/session/services.h"

namespace imomushi {

struct BuiltCharacter;
class InputFeed;
class LiveCharacter;
class Performer;
class SendingThread;
struct StageTimes;
struct CharacterPlan;
struct PoseFinding;
struct PreparedStep;
struct Project;

/// A document that is being worked on, with its responses and its live character. Everything that changes the document goes through execute(). The other functions read, or advance time.
class Session {
public:
    /// `registry` must outlive the session. `store`: of responses, shared with other sessions; null: one of its own, in memory.
    explicit Session(const CommandRegistry& registry, std::shared_ptr<ResponseStore> store = nullptr);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Runs one command: {"do": name, key: value, ...}. Checks names, types and finiteness of every key first; on an error the document
    /// is as it was. Errors: "unknown-command", "unknown-key", "missing-key", "bad-type", "not-finite", "no-memory" (nothing changed), "no-memory-after" (an action that
    /// made a step and ran out of memory after that: undo takes it back), and the command's own.
    Result<Json> execute(const Json& command, const Progress& progress = {});

    [[nodiscard]] const Document& document() const { return history_.document(); }
    [[nodiscard]] const CommandRegistry& registry() const { return registry_; }

    // ---- history
    using Step = DocumentHistory::Step;
    [[nodiscard]] const std::vector<Step>& steps() const { return history_.steps(); }  ///< all, oldest first
    [[nodiscard]] int position() const { return history_.position(); }                 ///< how many of them are done; the rest can be redone
    /// See DocumentHistory::setDepth().
    void setHistoryDepth(int steps) { history_.setDepth(steps); }
    /// Of what "save" replaces and writes.
    void setVersionLimits(const VersionLimits& limits) { versions_ = limits; }
    [[nodiscard]] const VersionLimits& versionLimits() const { return versions_; }
    /// Commands between begin and end become one undo step (a drag gesture). cancelGesture() takes them back.
    void beginGesture();
    /// `named`: the step is called so, instead of after the last command.
    void endGesture(Step named = {});
    /// The same as part of the step before, where that is one of live input or of a take; else as a step of its own.
    void endGestureInLast(Step named);
    void cancelGesture() noexcept;
    /// Differs from what was last saved or opened, or has responses that were computed since.
    [[nodiscard]] bool modified() const { return history_.modified() || responses_.unsaved(); }
    [[nodiscard]] const std::filesystem::path& path() const { return history_.path(); }  ///< of the project file, empty: never saved
    /// The commands that make the document again, as "save-script" writes them; see DocumentHistory::hasScript().
    [[nodiscard]] std::vector<Json> script() const;
    [[nodiscard]] bool hasScript() const { return history_.hasScript(); }
    void setScriptBytes(std::size_t bytes) { history_.setScriptBytes(bytes); }

    // ---- responses: see DocumentResponses
    DocumentResponses& responses() { return responses_; }
    [[nodiscard]] const DocumentResponses& responses() const { return responses_; }
    using ResponseState = imomushi::ResponseState;
    using SharedResponse = imomushi::SharedResponse;
    [[nodiscard]] ResponseState responseState(PartId element) const { return responses_.stateOf(element); }
    [[nodiscard]] ResponseInput responseInput(PartId element) const { return responses_.inputOf(element); }
    [[nodiscard]] const SharedResponse* sharedResponse(PartId element) const { return responses_.sharedOf(element); }
    [[nodiscard]] std::shared_ptr<const ElementResponse> response(PartId element) const { return responses_.freshOf(element); }
    [[nodiscard]] ResponseEstimate responseEstimate(PartId element) const { return responses_.estimateOf(element); }
    /// See effectCost() in performance.h.
    [[nodiscard]] EffectCost effectCost(EffectKind effect) const;

    // ---- the live character: see LiveCharacter
    // Questions build the character where it is not the document's any more. While another thread steps it, they are answered by what its last frame shows.
    /// Null: there is none, or it cannot be built.
    Character* character() const;
    /// Null: there are no elements and no bones. Errors: those of LiveCharacter::built().
    Result<Character*> builtCharacter() const;
    /// See LiveCharacter::release() and reuse(): a character that another session built beside this one.
    [[nodiscard]] std::shared_ptr<const BuiltCharacter> releaseCharacter();
    void reuseCharacter(std::shared_ptr<const BuiltCharacter> built);
    /// Of the character that was built last.
    [[nodiscard]] const CharacterPlan& plan() const;
    [[nodiscard]] int elementIndex(PartId element) const;        ///< in character(), -1: none
    [[nodiscard]] int pointIndex(const EndpointRef& end) const;  ///< joint point in the skeleton, -1: none
    const Pose& shownPose() const;
    /// See pose_check.h. Errors: those of LiveCharacter::built().
    Result<std::vector<PoseFinding>> checkPose() const;
    /// What checkPose() would make first: see Character::missingWatches().
    std::vector<std::function<void()>> missingWatches() const;
    Result<Vec3> positionOf(const EndpointRef& end) const;
    Result<HandlePose> poseOf(const FaceRef& handle) const;
    [[nodiscard]] Points positionsOf(PartId element) const;
    [[nodiscard]] Points renderPositionsOf(PartId character) const;
    bool moving() const;
    /// Advances by one frame (s). What "step" does `frames` times.
    void stepFrame(double seconds);
    /// From now on a thread of its own steps frames while anything moves; see Performer. Whatever changes the document stops it first, for one step at most.
    /// `stepped` is called on that thread after each step, and must return at once: takeFrame() then belongs on this one.
    void perform(std::function<void()> stepped);
    /// A target for the next step, of something that is held already (LiveInput). Until the gesture ends, mappings do not move it. False: no performer runs, or its queue is full; then use a command.
    bool give(const LiveInput& input);
    /// Live input for these steps, which go on as long as it is there; see Performer::feed(). Null: no more. False: frames are not stepped on a thread of their own.
    bool performInputs(std::shared_ptr<InputFeed> feed);
    /// What is shown is given there from now on, and once at once; see Performer::send(). Null: nowhere.
    void performOutputs(SendingThread* to);
    /// Live input moves something that nobody holds: holdInputs() is due.
    [[nodiscard]] bool inputsWait() const;
    /// Grabs, by commands, every target that live input moves and that nothing holds. Undo of these commands restores what was before. True: something was grabbed. Errors: those of "drag", "morph" and "set".
    Result<bool> holdInputs();
    /// All is at rest, and something that holdInputs() grabbed is moved by no live input any more (InputDriver::moves()): releaseInputs() is due. True once for each rest.
    [[nodiscard]] bool inputsLeft();
    /// Lets that go, by commands. Errors: those of "release".
    Result<void> releaseInputs();
    /// Questions are answered from the frame that was stepped last, from now on. False: none was stepped since the last call.
    bool takeFrame();
    /// The last frame that was taken, while frames are stepped on a thread of their own: how many were stepped, and what it took, ms. None: they are not.
    struct Performed {
        std::uint64_t step = 0;
        double milliseconds = 0.0;
        InputTime input = 0;   ///< when the oldest input came that this frame shows first; 0, or the same as before: it shows none
        double leftOut = 0.0;  ///< s that were skipped so far, as steps took longer than their time
    };
    [[nodiscard]] std::optional<Performed> performed() const;
    [[nodiscard]] std::optional<double> effectMilliseconds(EffectKind effect) const;
    /// Of the last frame, see live_character.h; none without a character.
    [[nodiscard]] std::optional<StageTimes> stages() const;
    [[nodiscard]] unsigned warnings() const;                                 ///< of FrameWarning, see LiveCharacter
    /// What is being recorded (the command "record"); none: nothing.
    struct Recording {
        std::string take;
        std::size_t frames = 0;
        double seconds = 0.0;
        bool ended = false;  ///< it takes no more frames: the character is another one, or the take is full
    };
    [[nodiscard]] std::optional<Recording> recording() const;
    /// A take is what is seen (the command "play"), not the pose of the document.
    [[nodiscard]] bool showsTake() const;

    // ---- for studio and recovery
    /// What a command or gesture changed.
    struct Change {
        DocumentChange document;  ///< the parts that changed, as they were
        bool replaced = false;    ///< another document took its place
        bool history = false;     ///< steps: one was made or joined to the gesture, undone or redone
        bool pose = false;        ///< what is shown moved
        bool responses = false;
        bool file = false;        ///< path or saved state
        [[nodiscard]] bool structure() const { return replaced || document.structure(); }
    };
    /// Called after each change, on the caller's thread. It must not throw: what it is told has happened.
    void setListener(std::function<void(const Change&)> listener);
    /// What slow work commands ask for; see Services.
    [[nodiscard]] Services& services() { return services_; }
    /// Takes over what was prepared, as its commands would have done it. It fits the document. Errors: "no-memory"; then nothing has changed.
    Result<Json> takePrepared(const PreparedStep& made);
    /// What "save" writes, and an autosave: the document as it is now with the responses that its elements have. Copies no mesh and no response.
    [[nodiscard]] Project project();

private:
    friend class SessionAccess;
    /// Throws std::bad_alloc only while nothing has changed.
    Result<Json> executeOrThrow(const Json& command, const Progress& progress);
    /// Runs a command that was checked, and what follows from it.
    Result<Json> runChecked(const Command& command, const Json& arguments, const Document& before, const Progress& progress);
    Json takeOver(const PreparedStep& made);
    /// The gesture is over: live input goes on from where hands left things.
    void leaveHands() noexcept;
    // Taking back works without memory.
    void takeBack(Document&& before) noexcept;
    [[nodiscard]] Change changeSince(const Document& before) const noexcept;
    void tell(const Change& change) noexcept;
    void tellOfMeetings();  ///< of flesh
    /// The document that was replaced is back.
    void putBack();
    /// Takes back the gesture that goes on. The document as it was with it.
    Document dropGesture() noexcept;

    const CommandRegistry& registry_;
    DocumentHistory history_;
    VersionLimits versions_;
    DocumentResponses responses_;
    std::unique_ptr<LiveCharacter> live_;
    std::unique_ptr<Performer> performer_;  // null: frames are stepped here
    struct HeldForInputs {
        LiveInput input;
        FaceRef handle;  // of one: its number in the plan may be another one by now
        int since = 0;   // the position in the history from which on inputs hold it
    };
    std::vector<HeldForInputs> heldForInputs_;  // ends and handles that holdInputs() grabbed and nobody else since; let go or undone they stay, as undo and redo hold them again
    bool forInputs_ = false;                    // a command of holdInputs() or releaseInputs()
    Result<void> executeForInputs(const Json& command);
    /// The command that lets it go. Null: it is not held, or not by inputs yet at this place of the history.
    [[nodiscard]] Json releasing(const HeldForInputs& held) const;
    /// What else takes hold of something that inputs held, or lets it go, has it from now on.
    void leaveToArtist(const DocumentChange& change);
    /// They are called as the plan calls them now.
    void followHeld();
    std::uint64_t lookedAt_ = 0;            // the step at which inputsLeft() looked last
    std::vector<LiveInput> byHand_;         // what the gesture that goes on was given by give()
    std::function<void(const Change&)> listener_;
    Services services_ = coreServices();
    /// What another document took the place of, until the command that did it has ended.
    struct Former {
        DocumentHistory history;
        DocumentResponses::Remembered responses;
    };
    std::optional<Former> former_;
    Change pendingChange_;  // by the command that runs, besides the parts of the document
    bool historyMoved_ = false;  // by the action that runs: undo, redo, another document, a take
};

}  // namespace imomushi
