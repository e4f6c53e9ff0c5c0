// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/document/command.h"
#include "core/document/document.h"
#include "core/document/document_change.h"
#include "core/document/script_lines.h"

namespace imomushi {

/// A document with its undo and redo (the last steps: setDepth()), its file, and the script that makes it again. Nothing derived: no character, no response.
class DocumentHistory {
public:
    struct Step {
        std::string name;     ///< of the command ("add-bone"), for display through tr()
        std::string subject;  ///< what it was done to
    };

    DocumentHistory();
    [[nodiscard]] const Document& document() const { return document_; }

    // Where memory runs out (std::bad_alloc), each of these leaves everything as it was.

    // ---- one change: edit(), then either commit() or rollBack() with the document as it was before
    Document& edit() { return document_; }
    /// Makes what changed since `before` one undo step, or a part of the gesture that goes on. `line`: the command, for the script.
    void commit(Step step, const Document& before, const Json& line);
    /// Makes `before` the document again. Returns the document as it was at the call. Does not allocate.
    Document rollBack(Document&& before) noexcept { return std::exchange(document_, std::move(before)); }
    /// Makes `after` the document, as one undo step of its own. In an open gesture, its commands so far become a step before this one, and the gesture goes on as a new step. `lines`: for the script.
    void addStep(Step step, Document after, const std::vector<Json>& lines);

    /// What passes with time is no step: the pose, glides, and flesh that meets.
    Document& passing() { return document_; }

    /// Live input changes this value from now on without steps of its own. The present value becomes part of the latest step (or of the open gesture), so that undo of that step restores it.
    void passesOn(const MorphRef& morph);
    void effectsPassOn();

    // ---- undo and redo: `count` steps at once
    /// Errors: "nothing-to-undo"; then nothing changes.
    Result<void> undo(int count);
    /// Errors: "nothing-to-redo"; then nothing changes.
    Result<void> redo(int count);
    [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }  ///< all, oldest first
    [[nodiscard]] int position() const { return position_; }                 ///< how many of them are done; the rest can be redone
    static constexpr int kDepth = 1000;
    /// How many steps are kept from now on, at least 1: the oldest go first, and what only they held. The script keeps their lines.
    void setDepth(int steps);
    void setLimits(const DocumentHistory& asOf) { depth_ = asOf.depth_, mostScriptBytes_ = asOf.mostScriptBytes_; }

    // ---- gestures: all commits between begin and end become one step, named after the last of them
    void beginGesture();
    /// False: nothing was committed, so there is no step. `named`: the step is called so instead.
    bool endGesture(Step named = {});
    /// The same, but what the gesture did becomes part of the step before it, which undo takes back with it. Only where steps() ends at the position, and not where that step is what was saved: false, and nothing happens.
    bool endGestureInLast();
    /// Restores the document of beginGesture(); ids that were given out stay used. Returns the document as it was before the call. Only in a gesture; takes no memory.
    Document cancelGesture() noexcept;
    [[nodiscard]] bool inGesture() const { return gesture_.has_value(); }

    // ---- file
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }  ///< empty: never saved
    /// The document differs from what was last saved or opened.
    [[nodiscard]] bool modified() const;
    void markSaved(std::filesystem::path path);
    /// Another document, without any step. `saved`: `path` holds it. `line`: the command that did it, for the script.
    void replace(Document document, std::filesystem::path path, bool saved, const Json& line);

    // ---- script
    /// A line that belongs into the script without being a step (precompute).
    void note(const Json& line);
    /// A frame of `seconds` was stepped: takes depend on frames. Frames become one line when flushFrames() is called.
    void noteFrame(double seconds);
    /// What a hand or a device gave before the frame that is noted next: an input of the command "step", without its frame. Only where there is a script.
    void noteInput(Json input);
    /// Drops the script (hasScript() becomes false): there was no memory for its next line.
    void forgetScript() noexcept;
    void flushFrames();
    /// The commands that make this document again, oldest first. What was undone is left out, and frames that no take depends on. Where there is one: see hasScript().
    [[nodiscard]] std::vector<Json> script() const;
    /// False: its lines took more memory than they may, and went. It begins anew, from the project file, when that is saved.
    [[nodiscard]] bool hasScript() const { return scriptFrom_ && position_ >= *scriptFrom_; }
    static constexpr std::size_t kScriptBytes = std::size_t{128} << 20;  ///< hours of dragging
    void setScriptBytes(std::size_t bytes);

private:
    /// A step and the exchange that undoes and redoes it.
    struct Entry {
        DocumentChange change;
        ScriptLines lines;
    };
    struct Gesture {
        Document before;
        ScriptLines lines;
        Step step;  ///< without a name: nothing was committed
        std::set<MorphRef> morphs;  ///< that pass on
        bool effects = false;
    };
    /// A step that led from one document to the other.
    [[nodiscard]] static Entry entryOf(const Document& before, const Document& after, ScriptLines lines);
    /// For this many steps that are pushed next.
    void makeRoom(std::size_t steps);
    void push(Step&& step, Entry&& entry) noexcept;
    /// Where lines of the script are added: to the gesture, or to what was done last. Null: there is no script.
    [[nodiscard]] ScriptLines* lastLines(bool ofGesture);
    /// What is kept of lines that are about to be added.
    [[nodiscard]] std::string kept(std::string lines);
    void noteText(std::string text);
    void dropLines();
    void dropOldest();
    /// Undoes entries [first, last) or redoes them.
    void exchangeEntries(int first, int last, bool redo);

    Document document_;
    std::filesystem::path path_;
    std::vector<Entry> entries_;
    std::vector<Step> steps_;        // of entries_
    ScriptLines firstLines_;         // before the first entry: "new" or "open", notes, and steps that are not kept any more
    int depth_ = kDepth;
    int position_ = 0;
    int savedPosition_ = 0;          // -1: no number of undos or redos leads back to the saved state
    std::optional<Gesture> gesture_;
    /// What passed and is no line yet.
    struct Passed {
        std::vector<double> frames;  // s each
        std::string inputs;          // of these, as they stand in the line, each after a comma
        std::size_t count = 0;       // of the inputs
    };
    Passed passed_;
    std::size_t scriptBytes_ = 0;    // of all lines; those that were undone count until other steps replace them
    std::size_t mostScriptBytes_ = kScriptBytes;
    std::optional<int> scriptFrom_ = 0;  // firstLines_ and the lines of entries from here on are the script; none: lines are missing
};

}  // namespace imomushi
