// SPDX-License-Identifier: GPL-3.0-or-later
// Takes of the live character: recording what frames show, and showing it again.
#include <algorithm>

#include "core/base/try.h"
#include "core/live/live_character.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

/// Bytes in memory: a take that is being recorded ends there. An hour of thirty elements that all move takes about 2.5e9. Saving needs a block more.
constexpr std::size_t kMaxTakeBytes = std::size_t{1} << 32;

bool sameTarget(const EndpointGoal& a, const EndpointGoal& b) { return a.pinned == b.pinned && a.target == b.target && a.roll == b.roll; }

}  // namespace

bool LiveCharacter::fits(const Take& take) const { return character_ && take.elements == plan_.elements && take.layout == character_->shapeLayout(); }

bool LiveCharacter::sameSkeleton(const Take& take) const {
    const Skeleton& skeleton = plan_.input.skeleton;
    if (take.bones.size() != plan_.bones.size() || take.points != static_cast<int>(skeleton.points.size())) return false;
    for (std::size_t b = 0; b < take.bones.size(); ++b) {
        const Take::Bone& was = take.bones[b];
        if (was.bone != plan_.bones[b] || was.start != skeleton.bones[b].start || was.end != skeleton.bones[b].end) return false;
    }
    return true;
}

Take LiveCharacter::emptyTake(const std::string& name) const {
    Take take;
    take.name = name;
    take.elements = plan_.elements;
    take.layout = character_->shapeLayout();
    take.points = static_cast<int>(plan_.input.skeleton.points.size());
    for (std::size_t b = 0; b < plan_.bones.size(); ++b) take.bones.push_back({plan_.bones[b], plan_.input.skeleton.bones[b].start, plan_.input.skeleton.bones[b].end});
    return take;
}

Result<void> LiveCharacter::startRecording(const std::string& name) {
    IMOMUSHI_TRY(auto alive, built());
    if (!alive) return fail("no-element", "There is nothing to record: import an element or add a bone first.");
    if (shownTake_) showPose();
    Recording made;
    made.take = emptyTake(name);
    recording_ = std::move(made);
    character_->keepExact(true);
    recordFrame(0.0);
    return {};
}

void LiveCharacter::recordFrame(double seconds) {
    if (!recording_ || !recording_->going || !character_) return;
    Recording& r = *recording_;
    Take& take = r.take;
    r.going = sameSkeleton(take) && fits(take) && take.bytes() < kMaxTakeBytes;
    if (!r.going) return;
    // Times of a take rise. Steps so short that the time stays the same add up until it does not.
    r.passed += seconds;
    const double now = take.duration() + r.passed;
    if (!take.times.empty() && !(now > take.times.back())) return;
    r.passed = 0.0;
    const std::size_t frames = take.times.size();
    std::vector<double> shape(static_cast<std::size_t>(take.layout.size()));
    character_->shape(shape.data());
    // A frame is there as a whole or not at all.
    take.shapes.add(shape);
    try {
        take.times.push_back(now);
        take.poses.add(poseNumbers(performance_ ? performance_->pose() : posed()));
    } catch (...) {
        take.shapes.removeLast();
        take.times.resize(std::min(take.times.size(), frames));
        throw;
    }
    const auto& targets = document().goals;
    for (const auto& [end, held] : targets) {
        const auto known = r.goals.find(end);
        if (known == r.goals.end() || !sameTarget(known->second, held)) take.targets.push_back({now, end.bone, end.atEnd, true, held.pinned, held.target, held.roll});
    }
    for (const auto& [end, held] : r.goals)
        if (!targets.contains(end)) take.targets.push_back({now, end.bone, end.atEnd, false, false, Vec3::Zero(), {}});
    r.goals = targets;
}

Take LiveCharacter::recordedTake() const {
    Take take = recording_->take;
    take.poses.finish();
    take.shapes.finish();
    return take;
}

void LiveCharacter::endRecording() noexcept {
    recording_.reset();
    if (character_) character_->keepExact(false);
}

Result<Take> LiveCharacter::playThrough(const std::string& name, const std::vector<double>& times, const std::function<PlayedFrame(double time)>& frameAt, const Progress& progress) {
    IMOMUSHI_TRY(auto alive, built());
    if (!alive) return fail("no-element", "There is nothing to record: import an element or add a bone first.");
    Take take = emptyTake(name);
    take.times = times;
    std::vector<double> shape(static_cast<std::size_t>(take.layout.size()));
    character_->keepExact(true);
    bool cancelled = false, tooFar = false, tooLong = false;
    for (std::size_t f = 0; f < times.size() && !cancelled && !tooLong; ++f) {
        const PlayedFrame frame = frameAt(times[f]);
        tooFar = std::any_of(frame.pose.points.begin(), frame.pose.points.end(), [](const Vec3& p) { return !(p.cwiseAbs().maxCoeff() <= kMaxCoordinate); });
        if (tooFar) break;
        for (const auto& [ref, weight] : frame.morphs)
            if (const auto mesh = std::find(plan_.characters.begin(), plan_.characters.end(), ref.character); mesh != plan_.characters.end())
                character_->setMorph(static_cast<int>(mesh - plan_.characters.begin()), ref.target, weight);
        if (f == 0) {
            character_->stop();
            character_->update(frame.pose);
        } else {
            character_->update(frame.pose, times[f] - times[f - 1]);
        }
        take.poses.add(poseNumbers(frame.pose));
        character_->shape(shape.data());
        take.shapes.add(shape);
        tooLong = take.bytes() > kMaxTakeBytes;
        progress.report("record", static_cast<double>(f + 1) / static_cast<double>(times.size()));
        cancelled = progress.cancelled();
    }
    character_->keepExact(recording_.has_value());
    jumpToPose();
    if (cancelled) return fail(kCancelled, "Recording the take was cancelled.");
    if (tooFar) return fail("bad-value", "The clip takes bones farther away than 1e9 m: its file is broken.");
    if (tooLong) return fail("too-long", "The take would not fit into memory: choose fewer frames per second.");
    take.poses.finish();
    take.shapes.finish();
    return take;
}

Result<bool> LiveCharacter::showTake(const Take& take, double time) {
    IMOMUSHI_TRY(auto alive, built());
    if (!alive) return fail("no-element", "There is nothing left to show a take with: undo to when it was recorded.");
    const TakeMoment moment = momentAt(take.times, time);
    positions_.clear();
    shownTake_ = takePose(take, moment, plan_.bones, plan_.input.skeleton);
    if (!fits(take)) {
        character_->stop();
        character_->update(*shownTake_);
        ++shows_;
        return false;
    }
    std::vector<double> numbers(take.shapes.width());
    take.shapes.at(moment.frame, numbers.data());
    if (moment.part > 0.0) {
        const std::vector<double> from = numbers;
        std::vector<double> to(numbers.size());
        take.shapes.at(moment.frame + 1, to.data());
        character_->between(from.data(), to.data(), moment.part, numbers.data());
    }
    character_->show(numbers.data());
    ++shows_;
    return true;
}

}  // namespace imomushi
