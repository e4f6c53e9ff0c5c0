// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/document_history.h"

#include <algorithm>
#include <utility>

namespace imomushi {

namespace {

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

std::string countText(int count, const char* none, const char* verb) {
    return count == 0 ? std::string(none) : "There are only " + std::to_string(count) + " steps to " + verb + ".";
}

}  // namespace

DocumentHistory::DocumentHistory() { firstLines_.push_back(Json{{"do", "new"}}); }

void DocumentHistory::commit(Step step, const Document& before, Json line) {
    if (gesture_) {
        gesture_->step = std::move(step);
        gesture_->lines.push_back(std::move(line));
        scriptValid_ = false;
    } else {
        push(std::move(step), before, {std::move(line)});
    }
}

void DocumentHistory::push(Step step, const Document& before, std::vector<Json> lines) {
    DocumentChange change = difference(before, document_);
    // The pose goes on changing as frames pass; undo leads back to the one of before.
    if (!change.pose && (!change.goals.empty() || movesJointPoints(change, document_))) change.pose = before.pose;
    if (savedPosition_ > position_) savedPosition_ = -1;
    entries_.resize(static_cast<std::size_t>(position_));
    steps_.resize(static_cast<std::size_t>(position_));
    steps_.push_back(std::move(step));
    entries_.push_back({std::move(change), std::move(lines)});
    ++position_;
    scriptValid_ = false;
}

void DocumentHistory::advanceGlides(double seconds) {
    for (auto& [end, held] : document_.goals)
        if (held.elapsed < held.seconds) held.elapsed = std::min(held.seconds, held.elapsed + seconds);
    for (auto& [handle, held] : document_.handleGoals)
        if (held.elapsed < held.seconds) held.elapsed = std::min(held.seconds, held.elapsed + seconds);
    for (auto& [part, turn] : document_.turns)
        if (turn.elapsed < turn.seconds) turn.elapsed = std::min(turn.seconds, turn.elapsed + seconds);
}

void DocumentHistory::exchangeEntry(int index) {
    exchange(document_, entries_[static_cast<std::size_t>(index)].change);
    scriptValid_ = false;
}

Result<std::vector<DocumentHistory::Step>> DocumentHistory::undo(int count) {
    if (count > position_) return fail("nothing-to-undo", countText(position_, "There is nothing to undo.", "undo"));
    std::vector<Step> done;
    for (; count > 0; --count) {
        exchangeEntry(--position_);
        done.push_back(steps_[static_cast<std::size_t>(position_)]);
    }
    return done;
}

Result<std::vector<DocumentHistory::Step>> DocumentHistory::redo(int count) {
    const int left = static_cast<int>(entries_.size()) - position_;
    if (count > left) return fail("nothing-to-redo", countText(left, "There is nothing to redo.", "redo"));
    std::vector<Step> done;
    for (; count > 0; --count) {
        done.push_back(steps_[static_cast<std::size_t>(position_)]);
        exchangeEntry(position_++);
    }
    return done;
}

void DocumentHistory::beginGesture() {
    flushFrames();
    gesture_ = Gesture{document_, {}, {}};
}

bool DocumentHistory::endGesture(Step named) {
    if (!gesture_) return false;
    flushFrames();
    Gesture gesture = std::move(*gesture_);
    gesture_.reset();
    if (gesture.step.name.empty()) {
        for (const Json& line : gesture.lines) note(line);
        return false;
    }
    push(named.name.empty() ? std::move(gesture.step) : std::move(named), gesture.before, std::move(gesture.lines));
    return true;
}

void DocumentHistory::cancelGesture() {
    if (!gesture_) return;
    DocumentChange change = difference(gesture_->before, document_);
    frames_.clear();
    gesture_.reset();
    exchange(document_, change);
    scriptValid_ = false;
}

bool DocumentHistory::modified() const { return position_ != savedPosition_ || (gesture_ && !gesture_->step.name.empty()); }

void DocumentHistory::markSaved(std::filesystem::path path) {
    path_ = std::move(path);
    savedPosition_ = position_;
}

void DocumentHistory::replace(Document document, std::filesystem::path path, bool saved, Json line) {
    document_ = std::move(document);
    path_ = std::move(path);
    entries_.clear();
    steps_.clear();
    firstLines_.assign(1, std::move(line));
    position_ = 0;
    savedPosition_ = saved ? 0 : -1;
    gesture_.reset();
    frames_.clear();
    scriptValid_ = false;
}

void DocumentHistory::note(const Json& line) {
    if (gesture_)
        gesture_->lines.push_back(line);
    else if (position_ > 0)
        entries_[static_cast<std::size_t>(position_ - 1)].lines.push_back(line);
    else
        firstLines_.push_back(line);
    scriptValid_ = false;
}

void DocumentHistory::flushFrames() {
    if (frames_.empty()) return;
    const bool even = std::all_of(frames_.begin(), frames_.end(), [&](double dt) { return dt == frames_[0]; });
    const Json line{{"do", "step"}, {"frames", frames_.size()}, {"dt", even ? Json(frames_[0]) : Json(frames_)}};
    frames_.clear();
    note(line);
}

const std::vector<Json>& DocumentHistory::script() const {
    if (scriptValid_) return script_;
    std::vector<Json> all = firstLines_;
    for (int i = 0; i < position_; ++i) {
        const auto& lines = entries_[static_cast<std::size_t>(i)].lines;
        all.insert(all.end(), lines.begin(), lines.end());
    }
    script_ = withoutLeftovers(all);
    scriptValid_ = true;
    return script_;
}

}  // namespace imomushi
