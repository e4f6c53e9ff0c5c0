// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/document/character_input.h"
#include "core/document/history.h"
#include "core/document/performance.h"
#include "core/document/session.h"
#include "core/reduction/congruence.h"

namespace imomushi {

/// One step of the history: how to exchange it, and the commands that made it.
struct HistoryEntry {
    Session::Step step;
    DocumentChange change;
    std::vector<Json> lines;
};

/// What a session keeps. Commands see it; nobody else does.
struct Session::State {
    explicit State(const CommandRegistry& registry_) : registry(registry_) {}

    const CommandRegistry& registry;
    Document document;
    ResponseCache responses;
    std::filesystem::path path;
    std::function<void(const Change&)> listener;
    std::function<Result<ImportResult>(const ImportRequest&, const Progress&)> importer;

    // ---- history
    std::vector<HistoryEntry> entries;
    std::vector<Step> steps;        ///< of entries
    std::vector<Json> firstLines;   ///< commands before the first entry: "new" or "open"
    int position = 0;
    int savedPosition = 0;          ///< -1: the saved state cannot be reached any more
    struct Gesture {
        Document before;
        std::vector<Json> lines;
        Step step;
    };
    std::optional<Gesture> gesture;
    std::vector<double> frames;     ///< stepped since the last command, s each: scripts need them to make takes again
    mutable std::vector<Json> script;
    mutable bool scriptValid = false;

    // ---- live
    CharacterPlan plan;
    std::optional<Character> character;
    std::optional<Error> characterError;
    bool characterValid = false;
    std::uint64_t responsesSeen = 0;
    std::vector<Hold> holds;
    std::optional<Performance> performance;  ///< where effects want one
    bool performanceValid = false;
    std::array<double, kEffects> effectMs = {};  ///< of the last frame; negative: it had no such effect
    std::vector<Hold> settledHolds;  ///< of which the pose is the last word of inverse kinematics, while `poseSettled`
    bool poseSettled = false;
    bool stirred = false;           ///< poses or targets changed since everything came to rest
    struct LastResponse {
        ContentKey key;
        ContentKey shape;           ///< of mesh, faces and basis: with another nu, or without what effects ask for, it still fits
    };
    /// What the document asks of the response of an element, besides the element itself.
    struct Asked {
        BasisChoice basis;
        bool loads = false;
        int touch = 0;
        bool operator==(const Asked&) const = default;
    };
    [[nodiscard]] Asked askedOf(PartId element) const;
    std::map<PartId, LastResponse> lastResponses;
    std::map<PartId, Points> results;  ///< deform-element: what write-mesh writes instead, until the character moves
    struct KnownKey {
        std::shared_ptr<const Element> element;
        Asked asked;
        ContentKey key, shape;
        std::shared_ptr<const ElementResponse> fitting = {};  ///< the last response that was found to fit
    };
    mutable std::map<PartId, KnownKey> keys;
    /// Which elements are congruent, as of `elements` and `asked`. Pairs are remembered by content, so that changing one element compares only that one again.
    struct Sharing {
        std::map<PartId, std::shared_ptr<const Element>> elements;
        std::map<PartId, Asked> asked;
        std::map<PartId, SharedResponse> shared;
        std::map<std::pair<ContentKey, ContentKey>, std::shared_ptr<const Congruence>> pairs;  ///< null: not congruent
    };
    mutable Sharing sharing;
    struct RecordedTake {
        Take take;
        std::vector<std::vector<double>> poses, shapes;
        std::map<EndpointRef, Held> held;  ///< as of the last frame
        bool going = true;                 ///< false: it ended, as the character is another one or the take is full
    };
    std::optional<RecordedTake> recording;
    std::optional<Pose> shownTake;  ///< the pose of a take that is shown instead of the document's
    Change pending;                 ///< of the command that runs

    /// The key of an element's response as it is now, and of its shape: what decides whether the response of another nu still fits.
    KnownKey& keysOf(PartId element) const;
    ResponseInput inputOf(PartId element) const;
    /// See Session::sharedResponse() and responseEstimate().
    const SharedResponse* sharedOf(PartId element) const;
    ResponseEstimate estimateOf(PartId element) const;
    /// estimateResponse(), each answer remembered: it takes part of a second for many elements, and panels ask for every effect again and again.
    ResponseEstimate estimateOf(const ResponseInput& input) const;
    mutable std::map<std::pair<ContentKey, int>, ResponseEstimate> estimates;  ///< by key and threads
    /// The response of an element as it is now, null: none. `lastToo`: also the last one of another nu, where it still fits.
    std::shared_ptr<const ElementResponse> responseOf(PartId element, bool lastToo) const;

    /// The live character, built when needed. Null with an empty document. Errors: those of planCharacter and Character::build.
    Result<Character*> live();
    void invalidateCharacter() { characterValid = false; }
    /// Fills `holds` with the targets as they are now.
    void collectHolds();
    /// Makes `performance` what the effects of the document ask for. Errors: those of Performance.
    Result<void> prepare();
    /// Solves the static pose towards what is held; with bone dynamics the shown pose follows as frames pass.
    struct Settled {
        int iterations = 0;
        bool settled = true;
        double milliseconds = 0.0;
        unsigned warnings = 0;
    };
    Result<Settled> settle();
    /// The rest pose, as far as what is held allows: where bone dynamics take a body that is let go.
    void relax();
    /// Puts the fingers of the character where the document has them.
    void applyTouches();
    /// Begins a take with what is shown. Errors: those of live(), "no-element".
    Result<void> startRecording(const std::string& name, const Json& line);
    /// Adds what is shown now, `seconds` after the last frame, to the take that is being recorded.
    void recordFrame(double seconds);
    /// Makes it a part of the document, as one step of the history.
    std::shared_ptr<const Take> stopRecording(const Json& line);
    /// Shows a take at a time (s). False: its poses alone, as the character is another one. Errors: those of live().
    Result<bool> showTake(const Take& take, double time);
    /// Shows the document again.
    void leaveTake();
    /// Deforms the character to the document's pose; no time passes, and what swings goes on swinging.
    void showPose();
    /// The same, and nothing moves any more.
    void jumpToPose();
    /// Where an endpoint is now, m.
    Result<Vec3> positionOf(const EndpointRef& end);
    /// One sentence for each bit of FrameWarning, and what the plan says.
    std::vector<std::string> warningTexts(unsigned warnings) const;
    EffectCost costOf(EffectKind effect) const;
    /// Body vertices of an element as they are now (results of deform-element included), double precision, m.
    Points currentPositions(PartId element);

    // ---- what commands do to the session itself
    /// What a command that changed the document asks of the rest: another skeleton begins from its rest pose, other bodies want another character. Errors: those of
    /// planCharacter, settle() and live().
    Result<void> follow(const Document& before);
    Result<void> followSkeleton(const Document& before);
    /// Takes back what a failed command left.
    void takeBack(const Document& before);
    /// Replaces everything by another document. `line`: the command that did it, for the script.
    void replaceDocument(Document fresh, std::filesystem::path file, Json line);
    Result<std::vector<Step>> undo(int count);
    Result<std::vector<Step>> redo(int count);
    /// A line that belongs into the script without being a step (precompute).
    void note(const Json& line);
    /// Notes the frames since the last command.
    void noteFrames();
    const std::vector<Json>& allLines() const;

    void push(Step step, DocumentChange change, std::vector<Json> lines);
    void afterExchange(const DocumentChange& change);
    void trimPose();
};

}  // namespace imomushi
