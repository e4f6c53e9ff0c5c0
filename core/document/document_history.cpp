// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/document_history.h"

#include <algorithm>
#include <new>
#include <sstream>
#include <type_traits>
#include <utility>

namespace imomushi {

namespace {

constexpr std::size_t kMostFrames = 10'000;  // that become one line of a script: a few minutes
constexpr std::size_t kMostInputs = 1'000;   // of that line: 100 kB, which is made into a line between two steps, of memory that the system need not clear first

bool records(const Json& line, const char* action) { return line["do"] == "record" && line["action"] == action; }

/// The lines of a script without frames that no take depends on and without recordings that came to nothing.
std::vector<Json> withoutLeftovers(const std::vector<Json>& all) {
    std::size_t end = all.size();  // of what the last take depends on
    while (end > 0 && !records(all[end - 1], "stop")) --end;
    std::vector<Json> kept;
    Json open;  // name of the take that is being recorded
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Json& line = all[i];
        if (line["do"] == "step" && i >= end) continue;
        if (records(line, "start")) {
            // A recording whose end was undone leaves its start behind.
            const auto ends = [&](const Json& other) { return records(other, "stop") && other["take"] == line["take"]; };
            const auto next = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, all.end(), [&](const Json& other) { return ends(other) || records(other, "start"); });
            if (next == all.end() || !ends(*next)) continue;
            open = line["take"];
        } else if (records(line, "stop")) {
            // An undo while it ran took its start away.
            if (open != line["take"]) kept.push_back({{"do", "record"}, {"take", line["take"]}, {"action", "start"}});
            open = nullptr;
        }
        kept.push_back(line);
    }
    return kept;
}

/// A change has this weight as it is in a document.
void keepMorph(DocumentChange& change, const MorphRef& morph, const Document& before) {
    const auto known = before.morphs.find(morph);
    change.morphs.try_emplace(morph, known == before.morphs.end() ? std::nullopt : std::optional(known->second));
}

std::string textOf(const Json& line) { return line.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n'; }

std::string countText(int count, const char* none, const char* verb) {
    return count == 0 ? std::string(none) : "There are only " + std::to_string(count) + " steps to " + verb + ".";
}

}  // namespace

static_assert(std::is_nothrow_move_constructible_v<Document> && std::is_nothrow_move_assignable_v<Document>, "taking back moves documents");

DocumentHistory::DocumentHistory() {
    firstLines_ = ScriptLines(textOf(Json{{"do", "new"}}));
    scriptBytes_ = firstLines_.size();
}

void DocumentHistory::commit(Step step, const Document& before, const Json& line) {
    std::string text = kept(textOf(line));
    const std::size_t bytes = text.size();
    if (gesture_) {
        gesture_->lines.add(std::move(text));
        scriptBytes_ += bytes;
        gesture_->step = std::move(step);
    } else {
        Entry entry = entryOf(before, document_, ScriptLines(std::move(text)));
        makeRoom(1);
        scriptBytes_ += bytes;
        push(std::move(step), std::move(entry));
    }
}

void DocumentHistory::addStep(Step step, Document after, const std::vector<Json>& lines) {
    flushFrames();
    std::string text;
    for (const Json& line : lines) text += textOf(line);
    ScriptLines added(kept(std::move(text)));
    const std::size_t bytes = added.size();
    std::optional<Gesture> rest;
    std::optional<Entry> until;
    const bool empty = gesture_ && gesture_->step.name.empty();
    if (gesture_) {
        rest = Gesture{after, {}, {}, {}, false};
        if (ScriptLines* last = empty ? lastLines(false) : nullptr) last->makeRoom(gesture_->lines.parts().size());
        if (!empty) until = entryOf(gesture_->before, document_, {});
    }
    Entry entry = entryOf(document_, after, std::move(added));
    makeRoom(2);
    // From here on nothing fails.
    if (ScriptLines* last = empty ? lastLines(false) : nullptr) last->add(std::move(gesture_->lines));
    if (until) {
        until->lines = std::move(gesture_->lines);
        push(std::move(gesture_->step), std::move(*until));
    }
    scriptBytes_ += bytes;
    document_ = std::move(after);
    gesture_ = std::move(rest);
    push(std::move(step), std::move(entry));
}

DocumentHistory::Entry DocumentHistory::entryOf(const Document& before, const Document& after, ScriptLines lines) {
    DocumentChange change = difference(before, after);
    // The pose goes on changing as frames pass; undo leads back to the one of before.
    if (!change.pose && (!change.goals.empty() || movesJointPoints(change, after))) change.pose = before.pose;
    return {std::move(change), std::move(lines)};
}

void DocumentHistory::makeRoom(std::size_t steps) {
    const auto in = [steps](auto& list) {
        if (list.capacity() < list.size() + steps) list.reserve(2 * list.size() + steps);
    };
    in(entries_);
    in(steps_);
}

void DocumentHistory::push(Step&& step, Entry&& entry) noexcept {
    if (savedPosition_ > position_) savedPosition_ = -1;
    if (scriptFrom_ && *scriptFrom_ > position_) {  // it begins at what is no more
        dropLines();
        entry.lines.clear();
    }
    for (std::size_t i = static_cast<std::size_t>(position_); i < entries_.size(); ++i) scriptBytes_ -= entries_[i].lines.size();
    entries_.erase(entries_.begin() + position_, entries_.end());
    steps_.erase(steps_.begin() + position_, steps_.end());
    steps_.push_back(std::move(step));
    entries_.push_back(std::move(entry));
    ++position_;
    try {
        dropOldest();
    } catch (const std::bad_alloc&) {  // then with the next step
    }
}

void DocumentHistory::setDepth(int steps) {
    depth_ = std::max(steps, 1);
    dropOldest();
}

void DocumentHistory::dropOldest() {
    // Steps that can be redone are newer, but nothing leads there without those before: undone ones stay until something else is done.
    const int gone = std::min(static_cast<int>(entries_.size()) - depth_, position_);
    if (gone <= 0) return;
    std::size_t parts = 0;
    for (int i = 0; i < gone; ++i) parts += entries_[static_cast<std::size_t>(i)].lines.parts().size();
    firstLines_.makeRoom(parts);
    for (int i = 0; i < gone; ++i) firstLines_.add(std::move(entries_[static_cast<std::size_t>(i)].lines));
    entries_.erase(entries_.begin(), entries_.begin() + gone);
    steps_.erase(steps_.begin(), steps_.begin() + gone);
    position_ -= gone;
    savedPosition_ = savedPosition_ >= gone ? savedPosition_ - gone : -1;
    if (scriptFrom_) scriptFrom_ = std::max(0, *scriptFrom_ - gone);
}

void DocumentHistory::exchangeEntries(int first, int last, bool redo) {
    Document document = document_;
    std::vector<DocumentChange> changes;
    for (int i = first; i < last; ++i) changes.push_back(entries_[static_cast<std::size_t>(i)].change);
    for (std::size_t i = 0; i < changes.size(); ++i) exchange(document, changes[redo ? i : changes.size() - 1 - i]);
    document_ = std::move(document);
    for (std::size_t i = 0; i < changes.size(); ++i) entries_[static_cast<std::size_t>(first) + i].change = std::move(changes[i]);
    position_ = redo ? last : first;
}

Result<void> DocumentHistory::undo(int count) {
    if (count > position_) return fail("nothing-to-undo", countText(position_, "There is nothing to undo.", "undo"));
    exchangeEntries(position_ - count, position_, false);
    return {};
}

Result<void> DocumentHistory::redo(int count) {
    const int left = static_cast<int>(entries_.size()) - position_;
    if (count > left) return fail("nothing-to-redo", countText(left, "There is nothing to redo.", "redo"));
    exchangeEntries(position_, position_ + count, true);
    return {};
}

void DocumentHistory::beginGesture() {
    flushFrames();
    gesture_ = Gesture{document_, {}, {}, {}, false};
}

void DocumentHistory::passesOn(const MorphRef& morph) {
    if (gesture_) gesture_->morphs.insert(morph);
    else if (position_ > 0) keepMorph(entries_[static_cast<std::size_t>(position_ - 1)].change, morph, document_);
}

void DocumentHistory::effectsPassOn() {
    if (gesture_) gesture_->effects = true;
    else if (position_ > 0 && !entries_[static_cast<std::size_t>(position_ - 1)].change.effects) entries_[static_cast<std::size_t>(position_ - 1)].change.effects = document_.effects;
}

bool DocumentHistory::endGesture(Step named) {
    if (!gesture_) return false;
    flushFrames();
    if (gesture_->step.name.empty()) {
        if (ScriptLines* last = lastLines(false)) last->add(std::move(gesture_->lines));
        gesture_.reset();
        return false;
    }
    Entry entry = entryOf(gesture_->before, document_, {});
    for (const MorphRef& morph : gesture_->morphs) keepMorph(entry.change, morph, gesture_->before);
    if (gesture_->effects && !entry.change.effects) entry.change.effects = gesture_->before.effects;
    makeRoom(1);
    entry.lines = std::move(gesture_->lines);
    Step step = std::move(named.name.empty() ? gesture_->step : named);
    gesture_.reset();
    push(std::move(step), std::move(entry));
    return true;
}

bool DocumentHistory::endGestureInLast() {
    if (!gesture_ || gesture_->step.name.empty() || position_ == 0 || position_ != static_cast<int>(entries_.size()) || savedPosition_ == position_) return false;
    flushFrames();
    const DocumentChange& last = entries_.back().change;
    Document before = gesture_->before;
    DocumentChange back = last;
    exchange(before, back);
    DocumentChange change = entryOf(before, document_, {}).change;
    for (const auto& [morph, weight] : last.morphs) keepMorph(change, morph, before);
    for (const MorphRef& morph : gesture_->morphs) keepMorph(change, morph, before);
    if ((gesture_->effects || last.effects) && !change.effects) change.effects = before.effects;
    if (last.pose && !change.pose) change.pose = before.pose;
    if (ScriptLines* lines = lastLines(false)) lines->add(std::move(gesture_->lines));
    entries_.back().change = std::move(change);
    gesture_.reset();
    return true;
}

Document DocumentHistory::cancelGesture() noexcept {
    gesture_->before.nextId = document_.nextId;
    scriptBytes_ -= gesture_->lines.size();
    passed_ = {};
    Document left = std::exchange(document_, std::move(gesture_->before));
    gesture_.reset();
    return left;
}

bool DocumentHistory::modified() const { return position_ != savedPosition_ || (gesture_ && !gesture_->step.name.empty()); }

void DocumentHistory::markSaved(std::filesystem::path path) {
    if (!scriptFrom_) {
        firstLines_ = ScriptLines(textOf(Json{{"do", "open"}, {"path", path.string()}}));
        scriptBytes_ = firstLines_.size();
        scriptFrom_ = position_;
    }
    path_ = std::move(path);
    savedPosition_ = position_;
}

void DocumentHistory::replace(Document document, std::filesystem::path path, bool saved, const Json& line) {
    firstLines_ = ScriptLines(textOf(line));
    scriptBytes_ = firstLines_.size();
    scriptFrom_ = 0;
    document_ = std::move(document);
    path_ = std::move(path);
    entries_.clear();
    steps_.clear();
    position_ = 0;
    savedPosition_ = saved ? 0 : -1;
    gesture_.reset();
    passed_ = {};
}

void DocumentHistory::note(const Json& line) { noteText(textOf(line)); }

void DocumentHistory::noteText(std::string text) {
    text = kept(std::move(text));
    ScriptLines* last = lastLines(gesture_.has_value());
    if (!last) return;
    const std::size_t bytes = text.size();
    last->add(std::move(text));
    scriptBytes_ += bytes;
}

ScriptLines* DocumentHistory::lastLines(bool ofGesture) {
    if (!scriptFrom_) return nullptr;
    if (ofGesture) return &gesture_->lines;
    if (position_ < *scriptFrom_) dropLines();
    if (!scriptFrom_) return nullptr;
    return position_ > *scriptFrom_ ? &entries_[static_cast<std::size_t>(position_ - 1)].lines : &firstLines_;
}

std::string DocumentHistory::kept(std::string lines) {
    if (scriptFrom_ && scriptBytes_ + lines.size() > mostScriptBytes_) dropLines();
    return scriptFrom_ ? std::move(lines) : std::string();
}

void DocumentHistory::setScriptBytes(std::size_t bytes) {
    mostScriptBytes_ = bytes;
    if (scriptBytes_ > bytes) dropLines();
}

void DocumentHistory::dropLines() {
    scriptFrom_.reset();
    scriptBytes_ = 0;
    firstLines_ = {};
    for (Entry& entry : entries_) entry.lines = {};
    if (gesture_) gesture_->lines = {};
}

void DocumentHistory::forgetScript() noexcept {
    passed_ = {};
    dropLines();
}

void DocumentHistory::noteFrame(double seconds) {
    if (passed_.frames.size() >= kMostFrames) flushFrames();
    passed_.frames.push_back(seconds);
    if (passed_.count >= kMostInputs) flushFrames();
}

void DocumentHistory::noteInput(Json input) {
    if (!hasScript()) return;
    if (passed_.frames.size() >= kMostFrames) flushFrames();
    input["frame"] = passed_.frames.size();
    passed_.inputs += ',' + input.dump(-1, ' ', false, Json::error_handler_t::replace);
    ++passed_.count;
}

void DocumentHistory::flushFrames() {
    const std::vector<double>& frames = passed_.frames;
    if (!frames.empty()) {
        const bool even = std::all_of(frames.begin(), frames.end(), [&](double dt) { return dt == frames[0]; });
        std::string line = textOf({{"do", "step"}, {"frames", frames.size()}, {"dt", even ? Json(frames[0]) : Json(frames)}});
        // Values of so many would take a performance a tenth of a second.
        if (passed_.count > 0) line.replace(line.size() - 2, 1, ",\"inputs\":[" + passed_.inputs.substr(1) + "]}");
        noteText(std::move(line));
    }
    passed_ = {};
}

std::vector<Json> DocumentHistory::script() const {
    std::vector<Json> all;
    const auto add = [&all](const ScriptLines& lines) {
        for (const std::string& part : lines.parts()) {
            std::istringstream text(part);
            for (std::string line; std::getline(text, line);) all.push_back(Json::parse(line));
        }
    };
    add(firstLines_);
    for (int i = scriptFrom_.value_or(0); i < position_; ++i) add(entries_[static_cast<std::size_t>(i)].lines);
    return withoutLeftovers(all);
}

}  // namespace imomushi
