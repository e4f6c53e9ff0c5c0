// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/pose_fingers.h"

#include <algorithm>
#include <utility>

namespace imomushi {

std::vector<PoseFingers::Finger>::iterator PoseFingers::find(int id) {
    return std::find_if(fingers_.begin(), fingers_.end(), [&](const Finger& finger) { return finger.id == id; });
}

bool PoseFingers::land(int id, const PointerEvent& e, const ToolOptions& options) {
    Finger finger{id, std::make_unique<PoseTool>(document_)};
    finger.tool->setOptions(options);
    PointerEvent press = e;
    // What the next ones take is selected, too.
    if (busy()) press.modifiers |= Qt::ShiftModifier;
    if (!finger.tool->takeHold(press)) return false;
    if (const auto grip = finger.tool->dragged()) {
        for (const Finger& other : fingers_) {
            const auto held = other.tool->dragged();
            if (held == grip) return false;
            // Two fingers on both sides lead both.
            if (other.tool->moves(*grip)) other.tool->leaveImage();
            if (held && finger.tool->moves(*held)) finger.tool->leaveImage();
        }
    }
    fingers_.push_back(std::move(finger));
    if (gesture_) holdStill();
    return find(id) != fingers_.end();
}

void PoseFingers::holdStill() {
    for (const Finger& finger : fingers_) finger.tool->holdStill();
    dropRefused();
}

void PoseFingers::dropRefused() {
    std::erase_if(fingers_, [](const Finger& finger) { return !finger.tool->busy(); });
    if (!busy()) cancel();
}

void PoseFingers::move(int id, const PointerEvent& e) {
    const auto finger = find(id);
    if (finger == fingers_.end()) return;
    if (gesture_) {
        finger->tool->move(e);
        return dropRefused();
    }
    gesture_ = std::make_unique<Gesture>(document_);
    finger->tool->move(e);
    name_ = finger->tool->stepName();
    holdStill();
}

void PoseFingers::lift(int id, const PointerEvent& e) {
    const auto found = find(id);
    if (found == fingers_.end()) return;
    const Finger finger = std::move(*found);
    fingers_.erase(found);
    finger.tool->release(e);
    if (busy()) {
        if (gesture_) holdStill();
        return;
    }
    if (gesture_) gesture_->commit(name_);
    gesture_.reset();
}

void PoseFingers::cancel() {
    fingers_.clear();
    gesture_.reset();  // takes the commands of all back
}

void PoseFingers::decorate(render::Scene& scene) const {
    for (const Finger& finger : fingers_) finger.tool->decorate(scene);
}

// ---- how the pose tool has them ------------------------------------------------------------------------------------------

PoseTool::PoseTool(StudioDocument& document) : Tool(document), part_(document), snap_(document) {}

PoseTool::~PoseTool() = default;

bool PoseTool::fingersHold() const { return fingers_ && fingers_->busy(); }

Tool::Landing PoseTool::fingerLanded(int id, const PointerEvent& e) {
    if (modal()) return Landing::IsPointer;
    if (busy() && !fingersHold()) return Landing::FoundNothing;
    if (!fingers_) fingers_ = std::make_unique<PoseFingers>(document_);
    return fingers_->land(id, e, options_) ? Landing::Holds : Landing::FoundNothing;
}

void PoseTool::fingerMoved(int id, const PointerEvent& e) {
    if (fingers_) fingers_->move(id, e);
}

void PoseTool::fingerLifted(int id, const PointerEvent& e) {
    if (fingers_) fingers_->lift(id, e);
}

}  // namespace imomushi
