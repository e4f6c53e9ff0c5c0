// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/character/character.h"
#include "core/document/character_input.h"
#include "core/document/document_history.h"
#include "core/document/embed_model.h"
#include "core/document/take.h"
#include "core/live/live_input.h"
#include "core/live/performance.h"
#include "core/project/document_responses.h"

namespace imomushi {

/// Wall time of the stages of a frame, ms.
struct StageTimes {
    double pose = 0.0, joints = 0.0, equilibrium = 0.0, product = 0.0, normals = 0.0;  ///< `joints` without `equilibrium`
};
StageTimes stageTimes(const Character& character);

/// What steps change of a document, in the order of its maps.
struct PassedTime {
    Pose pose;
    std::vector<EndpointGoal> goals;
    std::vector<HandleGoal> handles;
    std::vector<TurnGoal> turns;
    std::vector<double> morphs;   ///< weights of all morph targets of all characters
    std::vector<double> numbers;  ///< of effects: Effect::values of each, one after the other
};

/// What a LiveCharacter built, for another one of a document that shares parts with its own. On any thread.
struct BuiltCharacter {
    Character character;
    EmbeddedModels models;
};

/// The character of a document as it moves: everything that is derived from the document and never saved. Built when somebody asks, from the responses that are
/// there; elements without a fresh one follow their bones rigidly, or with their last response while it still fits. Of the document it writes only what passes
/// with time, see DocumentHistory.
class LiveCharacter {
public:
    /// Both must outlive this.
    LiveCharacter(DocumentHistory& history, DocumentResponses& responses);

    /// Builds the character if needed and moves it out of this object; the next query builds a new one. Null: there is no character, or it cannot be built.
    [[nodiscard]] std::shared_ptr<const BuiltCharacter> release();
    /// built() takes over what fits when it builds next.
    void reuse(std::shared_ptr<const BuiltCharacter> built) { reusable_ = std::move(built); }

    /// As time has passed so far; between beginPerforming() and endPerforming() ahead of that of the history.
    [[nodiscard]] const Document& document() const { return performed_ ? *performed_ : history_.document(); }

    // ---- what it is
    /// Built anew where the document or the responses ask for it. Null with an empty document. Errors: those of planCharacter() and Character::build().
    Result<Character*> built();
    /// Of the character that built() made last.
    [[nodiscard]] const CharacterPlan& plan() const { return plan_; }
    /// built() has something to do: the document or the responses are newer than the character.
    [[nodiscard]] bool outOfDate() const { return !valid_ || responsesSeen_ != responses_.store().revision(); }
    /// How often a character was built here, got new settings for its effects, and changed what it shows.
    [[nodiscard]] std::uint64_t builds() const { return builds_; }
    [[nodiscard]] std::uint64_t tunes() const { return tunes_; }
    [[nodiscard]] std::uint64_t shows() const { return shows_; }
    /// The settings of effects that the character has.
    [[nodiscard]] CharacterEffects effects() const { return characterEffects(document()); }
    /// The same by effect, for whoever changes their numbers; null: it has no such effect.
    [[nodiscard]] std::array<std::shared_ptr<EffectSettings>, kEffects> settingsOfEffects() const;
    /// True: another Character displays the shape of this one, which then evaluates its vertices only where effects or queries need them. Takes effect with the next character that is built.
    void leaveVerticesToOthers(bool leave);
    /// The plan of any state of the document; the two latest are remembered. Errors: those of planCharacter().
    Result<std::shared_ptr<const CharacterPlan>> planOf(const Document& document);

    // ---- where it is
    /// The pose that is shown: the document's, or where effects have taken it, or that of a take. Empty: at rest.
    const Pose& shownPose();
    /// Like shownPose(), without building. There must be a character.
    [[nodiscard]] const Pose& presentPose() const;
    /// A handle of the plan as it is shown, in the world. There must be a character.
    [[nodiscard]] HandlePose presentHandle(int handle) const { return character_->shownHandle(handle); }
    /// Weights of the morph targets of a character of the plan, as they are shown. There must be a character.
    [[nodiscard]] const std::vector<double>& presentMorphs(int character) const { return character_->morphWeights(character); }
    /// Character::shape() of the character as it is.
    void shape(double* numbers) const { character_->shape(numbers); }
    /// Where an endpoint is shown, m. Errors: those of built().
    Result<Vec3> positionOf(const EndpointRef& end);
    /// Render vertices of a character as they are shown, in the order of its file, double precision, m.
    [[nodiscard]] Points renderPositionsOf(PartId character);
    /// Where a handle is shown, in the world. Errors: those of built(), "no-such-handle".
    Result<HandlePose> poseOf(const FaceRef& handle);
    /// The pose in the world, relative to what carries the handle now. Errors: as poseOf().
    Result<HandlePose> carried(const FaceRef& handle, const HandlePose& world);
    /// Body vertices of an element as they are shown, double precision, m.
    [[nodiscard]] Points positionsOf(PartId element);
    /// write-mesh and measure see these positions of an element, until the character moves.
    void showPositions(PartId element, Points positions) { positions_.insert_or_assign(element, std::move(positions)); }
    void hidePositions() { positions_.clear(); }

    // ---- posing
    struct Convergence {
        int iterations = 0;
        bool converged = true;
        double milliseconds = 0.0;
        unsigned warnings = 0;  ///< of FrameWarning
    };
    /// Solves the static pose towards the targets. With bone dynamics the shown pose follows as frames pass. Errors: those of built().
    Result<Convergence> converge();
    /// Sets the document's pose to rest and solves inverse kinematics towards the targets, at most 200 times. Does not update the character: bone dynamics move it there in the next frames. Errors: those of built().
    Result<void> returnToRest();
    /// Updates the character without advancing time: to the present pose of bone dynamics if they are on, else to the document's pose, raised above the ground if that effect is on. Velocities are kept. Ends the display of a take.
    void showPose();
    /// Resets all motion of bones and effects, then showPose().
    void jumpToPose();
    /// Puts a finger of the document on the character. False: it cannot be touched there.
    bool putFinger(const Touch& touch);

    // ---- time
    /// Advances glides, poses and effects by one frame (s) and updates the character.
    void stepFrame(double seconds);
    /// Moves the target of something that is held, for the next frame. The script keeps it with that frame. False: it is not held. On any thread that may step.
    bool apply(const LiveInput& input);
    /// Something goes on by itself: frames must be stepped to see it.
    bool moving();
    /// Like moving(), without building; there must be a character. Also true while its pose approaches what is held, and while it is recorded.
    [[nodiscard]] bool inMotion() const;

    // ---- time on another thread: see Performer
    /// Until endPerforming(), only advance() and const functions may be called, all from one thread: time passes in a copy of the document. Call built() before.
    void beginPerforming();
    /// stepFrame() of the character as it is. It does not build and does not throw; where memory runs out, a recording ends.
    void advance(double seconds) noexcept;
    /// Since beginPerforming(): what the steps made of the document. Takes memory only where `passed` is not of this stretch.
    void passed(PassedTime& passed) const;
    /// On the thread of whoever has the history, while another one steps: its document becomes what passed() said, without a step of the history.
    void bringPassed(const PassedTime& passed);
    /// Flesh of two elements has met since beginPerforming().
    [[nodiscard]] bool hasMet() const { return met_; }
    /// See GroundJob::landing(); of the last step.
    [[nodiscard]] double landing() const;
    /// The document of the history becomes what the copy is, without a step. Does nothing unless it was begun.
    void endPerforming() noexcept;
    /// Milliseconds that an effect took in the last frame; none: the frame did without it.
    [[nodiscard]] std::optional<double> effectMilliseconds(EffectKind effect) const;
    [[nodiscard]] const std::array<double, kEffects>& effectTimes() const { return effectMs_; }  ///< ms, by effect; negative: none
    /// Of the last frame; none without a character.
    [[nodiscard]] std::optional<StageTimes> stages() const { return character_ ? std::optional(stageTimes(*character_)) : std::nullopt; }
    /// Of FrameWarning: what the last frame has to say.
    [[nodiscard]] unsigned warnings() const;
    /// The last frame was longer than bone dynamics can follow.
    [[nodiscard]] bool droppedTime() const;
    /// One sentence for each bit of FrameWarning, and what the plan says.
    [[nodiscard]] std::vector<std::string> warningTexts(unsigned warnings) const;

    // ---- takes
    /// A take that is being recorded.
    struct Recording {
        Take take;
        std::map<EndpointRef, EndpointGoal> goals;   ///< as of the last frame
        double passed = 0.0;                         ///< s, since the last frame
        bool going = true;                           ///< false: it ended, as the character is another one or the take is full
    };
    [[nodiscard]] const std::optional<Recording>& recording() const { return recording_; }
    /// Begins a take with what is shown. Errors: those of built(), "no-element".
    Result<void> startRecording(const std::string& name);
    /// What is recorded so far, without an id.
    [[nodiscard]] Take recordedTake() const;
    void endRecording() noexcept;
    /// A frame of a take that is made at once.
    struct PlayedFrame {
        Pose pose;
        std::vector<std::pair<MorphRef, double>> morphs;  ///< weights of morph targets; others are as the document has them
    };
    /// A take of frames that are shown one after the other, without an id: what the flesh makes of them, without bone dynamics. Afterwards the document is shown, at rest.
    /// times: as Take::times. Errors: those of built(), "no-element", "too-long", "cancelled".
    Result<Take> playThrough(const std::string& name, const std::vector<double>& times, const std::function<PlayedFrame(double time)>& frameAt, const Progress& progress);
    /// Shows a take at a time (s). False: its poses alone, as the character is another one. Errors: those of built(), "no-element".
    Result<bool> showTake(const Take& take, double time);
    [[nodiscard]] bool showsTake() const { return shownTake_.has_value(); }
    /// True if the take has the element ids and the shape layout of this character, so that its shapes can be shown. Meshes are not compared.
    [[nodiscard]] bool fits(const Take& take) const;

    // ---- following the document: what the session calls when it has changed
    /// After a command: brings targets and pose along, see followSkeleton(). Errors: those of planCharacter(), converge() and built().
    Result<void> follow(const Document& before);
    /// Undoes what a failed command changed here. `failed`: the document as that command left it.
    void takeBack(const Document& failed) noexcept;
    /// After undo, redo, a prepared step and a gesture that was cancelled: jumps to the pose where targets or the pose differ; else what swings goes on.
    void followExchange(const Document& before) noexcept;
    /// Frees everything, after following ran out of memory. The next question builds it again.
    void drop() noexcept;
    /// Another document took the place of this one.
    void replace();
    /// The next frame is computed, even if everything was at rest. `posed`: targets or poses may have changed, so the pose is solved again.
    void wake(bool posed);
    /// If a take is shown, shows the pose of the document again.
    void leaveTake();

private:
    /// Plans depend on these parts of a document alone.
    struct KnownPlan {
        std::map<PartId, std::shared_ptr<const Element>> elements;
        std::map<PartId, std::shared_ptr<const Joint>> joints;
        std::map<PartId, std::shared_ptr<const Bone>> bones;
        CharacterSettings settings;
        Effects effects;
        std::shared_ptr<const CharacterPlan> plan;
    };
    /// The document, for what passes with time.
    Document& passing() { return performed_ ? *performed_ : history_.passing(); }
    /// As an input of the command "step".
    [[nodiscard]] Json lineOf(const LiveInput& input) const;
    /// See stepFrame(). Throws std::bad_alloc.
    void stepOn(double seconds);
    /// Character and bones act by the numbers that an effect has now. Takes no memory while time passes on another thread.
    void tuneAsPassed(EffectKind driven);
    /// Of bones, effects and glides.
    [[nodiscard]] bool swings() const;
    /// The pose of the document, rest where that is empty.
    [[nodiscard]] Pose posed() const;
    /// The same, which is then in the document.
    Pose& ownPose();
    [[nodiscard]] bool usesLatestResponses() const;
    /// Errors: those of built(); those of planning and building stay until the document is another.
    Result<void> build();
    /// Drops the document's pose if it is not of this skeleton.
    void dropForeignPose();
    /// Makes `performance_` what the effects of the document ask for. Errors: those of Performance.
    Result<void> prepare();
    /// Fills `goals_` with the targets as they are now.
    void collectGoals();
    /// Puts the handles of the character where the document has them. False: they were there.
    bool applyHandles();
    /// Turns rigid parts as the document has them. False: they were turned so.
    bool applyTurns();
    /// Weights of morph targets as the document has them. False: they were so.
    bool applyMorphs();
    /// Puts the fingers of the character where the document has them.
    void applyTouches();
    /// Tells the ground where flesh is shown.
    void seeFlesh();
    /// Shows a pose until no flesh of it is in the ground.
    void liftFlesh(const Pose& pose);
    void measureEffects();
    /// The bones of a take are those of the character, between the same joint points.
    [[nodiscard]] bool sameSkeleton(const Take& take) const;
    /// A take of the character as it is, without frames.
    [[nodiscard]] Take emptyTake(const std::string& name) const;
    /// Adds what is shown now, `seconds` after the last frame, to the take that is being recorded.
    void recordFrame(double seconds);

    DocumentHistory& history_;
    DocumentResponses& responses_;
    std::vector<KnownPlan> knownPlans_;  // latest last
    EmbeddedModels embeddedModels_;      // of characters
    std::shared_ptr<const BuiltCharacter> reusable_;

    CharacterPlan plan_;
    std::optional<Character> character_;
    std::optional<Character> former_;    // before character_: undo asks for its tables again
    std::optional<Error> error_;         // why there is no character
    bool valid_ = false;                 // character_ or error_ is that of the document
    std::uint64_t responsesSeen_ = 0;    // revision of the store
    std::optional<Performance> performance_;  // where effects want one
    std::optional<Performance> formerPerformance_;  // until the next one is built
    bool performanceValid_ = false;

    std::vector<IkGoal> goals_;
    std::vector<IkGoal> convergedGoals_;     // while poseConverged_: the pose is the last word of inverse kinematics on these
    bool poseConverged_ = false;
    bool awake_ = false;                 // poses or targets changed since everything came to rest
    bool approaching_ = false;           // the pose came nearer to what is held in the last frame, or that was not tried yet
    std::vector<Vec3> pointsBefore_;     // of the pose, m: room of stepOn()
    std::optional<Document> performed_;  // as time passes on another thread
    std::vector<double> performedFrames_;  // s each, that have passed there
    struct PerformedInput {
        std::size_t frame = 0;           // of performedFrames_
        LiveInput input;
    };
    std::vector<PerformedInput> performedInputs_;  // of each target and frame the last one
    bool scriptForgotten_ = false;       // there were too many
    std::optional<std::array<std::shared_ptr<EffectSettings>, kEffects>> tuned_;  // what tuneAsPassed() gives; null: an effect that the character has not
    bool drivenEffects_ = false;         // numbers of effects have passed since beginPerforming()
    bool met_ = false;
    bool leavesVertices_ = false;
    std::uint64_t builds_ = 0, tunes_ = 0, shows_ = 0;
    std::array<double, kEffects> effectMs_;  // of the last frame; negative: it had no such effect
    std::map<PartId, Points> positions_;     // see showPositions()
    std::optional<Recording> recording_;
    std::optional<Pose> shownTake_;      // the pose of a take that is shown instead of the document's
};

}  // namespace imomushi
