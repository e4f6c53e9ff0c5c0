// SPDX-License-Identifier: GPL-3.0-or-later
// How the pose tool holds what it drags, and what goes along on the other side: by commands, and in between by the performance.
#include "core/live/live_input.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/picking/picking.h"
#include "ui/tools/pose_tool.h"

namespace imomushi {

void PoseTool::holdStill() {
    if (flesh_ && !takeFlesh()) return;
    if (!drag_) return;
    if (!drag_->gesture) drag_->gesture = std::make_unique<Gesture>(document_);
    issue(PointerEvent(*last_));
}

bool PoseTool::give(const PoseGrip& grip, const Aim& to) {
    LiveInput input;
    input.kind = grip.isHandle() ? LiveInput::Kind::Handle : LiveInput::Kind::End;
    input.end = grip.end;
    if (grip.isHandle()) input.handle = document_.session().plan().handleIndex(grip.handle);
    input.target = to.to;
    input.rotation = to.rotation;
    input.hasRoll = to.roll.has_value();
    input.roll = to.roll.value_or(0.0);
    return document_.give(input);
}

bool PoseTool::dragTo(const PoseGrip& grip, const Aim& to) {
    const std::string name = pathOf(document_.document(), grip);
    return document_.execute(grip.isHandle() ? commands::dragHandle(name, to.to, to.rotation) : commands::drag(name, to.to, to.roll)).has_value();
}

PoseTool::Aim PoseTool::where(const PoseGrip& grip) const {
    Aim aim;
    if (const auto at = gripPosition(document_.session(), grip)) aim.to = *at;
    if (grip.isHandle()) {
        if (const auto pose = document_.session().poseOf(grip.handle)) aim.rotation = pose->rotation;
    } else if (const auto goal = document_.document().goals.find(grip.end); goal != document_.document().goals.end()) {
        aim.roll = goal->second.roll;
    }
    return aim;
}

void PoseTool::hold() {
    Drag& drag = *drag_;
    drag.held = dragTo(drag.end, where(drag.end)) && (!drag.image || dragTo(*drag.image, where(*drag.image)));
    if (!drag.held) cancel();
}

PoseTool::Aim PoseTool::mirrored(const Aim& to) const {
    return {drag_->symmetry->point(to.to), to.roll ? std::optional(-*to.roll) : std::nullopt, Symmetry::turn(to.rotation)};
}

}  // namespace imomushi
