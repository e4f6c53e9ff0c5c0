// SPDX-License-Identifier: GPL-3.0-or-later
// Takes of a session: recording what frames show, and showing it again.
#include "core/document/session_state.h"

namespace imomushi {

namespace {

constexpr std::size_t kMostTakeBytes = std::size_t{1} << 31;  // a take that is being recorded ends there

bool madeOf(const Take& take, const CharacterPlan& plan, const Character& character) {
    return take.elements == plan.elements && take.layout == character.shapeLayout();
}

}  // namespace

Result<void> Session::State::startRecording(const std::string& name, const Json& line) {
    auto alive = live();
    if (!alive) return tl::unexpected(alive.error());
    if (!*alive) return fail("no-element", "There is nothing to record: import an element or add a bone first.");
    if (shownTake) showPose();
    RecordedTake made;
    made.take.name = name;
    made.take.elements = plan.elements;
    made.take.layout = character->shapeLayout();
    made.take.points = static_cast<int>(plan.input.skeleton.points.size());
    for (std::size_t b = 0; b < plan.bones.size(); ++b)
        made.take.bones.push_back({plan.bones[b], plan.input.skeleton.bones[b].start, plan.input.skeleton.bones[b].end});
    recording = std::move(made);
    note(line);
    character->keepExact(true);
    recordFrame(0.0);
    return {};
}

void Session::State::recordFrame(double seconds) {
    if (!recording || !recording->going || !character) return;
    RecordedTake& r = *recording;
    Take& take = r.take;
    const std::size_t frameBytes = (poseNumbers(restPose(plan.input.skeleton)).size() + static_cast<std::size_t>(take.layout.size())) * sizeof(double);
    bool sameBones = take.bones.size() == plan.bones.size();
    for (std::size_t b = 0; sameBones && b < plan.bones.size(); ++b) sameBones = take.bones[b].bone == plan.bones[b];
    r.going = sameBones && madeOf(take, plan, *character) && take.times.size() * frameBytes < kMostTakeBytes;
    if (!r.going) return;
    const double now = take.duration() + seconds;
    take.times.push_back(now);
    const Pose& pose = performance ? performance->pose() : document.pose;
    r.poses.push_back(poseNumbers(pose.points.empty() ? restPose(plan.input.skeleton) : pose));
    character->shape(r.shapes.emplace_back(static_cast<std::size_t>(take.layout.size())).data());
    const auto told = [](const Held& a, const Held& b) { return a.pinned == b.pinned && a.target == b.target && a.roll == b.roll; };
    for (const auto& [end, held] : document.held) {
        const auto known = r.held.find(end);
        if (known == r.held.end() || !told(known->second, held)) take.targets.push_back({now, end.bone, end.atEnd, true, held.pinned, held.target, held.roll});
    }
    for (const auto& [end, held] : r.held)
        if (!document.held.contains(end)) take.targets.push_back({now, end.bone, end.atEnd, false, false, Vec3::Zero(), {}});
    r.held = document.held;
}

std::shared_ptr<const Take> Session::State::stopRecording(const Json& line) {
    RecordedTake recorded = std::move(*recording);
    recording.reset();
    if (character) character->keepExact(false);
    recorded.take.poses = FrameNumbers(recorded.poses);
    recorded.take.shapes = FrameNumbers(recorded.shapes);
    const Document before = document;
    recorded.take.id = document.nextId++;
    auto take = std::make_shared<const Take>(std::move(recorded.take));
    document.takes.emplace(take->id, take);
    pending.structure = true;
    push({"record", take->name}, difference(before, document, false), {line});
    return take;
}

Result<bool> Session::State::showTake(const Take& take, double time) {
    auto alive = live();
    if (!alive) return tl::unexpected(alive.error());
    if (!*alive) return fail("no-element", "There is nothing left to show a take with: undo to when it was recorded.");
    const TakeMoment moment = momentAt(take.times, time);
    results.clear();
    shownTake = takePose(take, moment, plan.bones, plan.input.skeleton);
    if (!madeOf(take, plan, *character)) {
        character->stop();
        character->update(*shownTake);
        return false;
    }
    std::vector<double> numbers(take.shapes.width());
    take.shapes.at(moment.frame, numbers.data());
    if (moment.part > 0.0) {
        const std::vector<double> from = numbers;
        std::vector<double> to(numbers.size());
        take.shapes.at(moment.frame + 1, to.data());
        character->between(from.data(), to.data(), moment.part, numbers.data());
    }
    character->show(numbers.data());
    return true;
}

void Session::State::leaveTake() {
    if (!shownTake) return;
    if (live()) showPose();
}

}  // namespace imomushi
