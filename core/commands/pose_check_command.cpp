// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/try.h"
#include "core/commands/core_commands.h"
#include "core/live/performance.h"
#include "core/live/pose_check.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

Result<Json> checkPoseCommand(SessionAccess& access, const Json&, const Progress&) {
    IMOMUSHI_TRY(const auto findings, checkPose(access.live));
    const Document& document = access.document();
    Json list = Json::array();
    for (const PoseFinding& f : findings) {
        Json one{{"element", document.elements.at(f.element)->name}, {"what", std::string(poseFindingName(f.kind))}, {"measure", f.measure}};
        if (f.mend) one["effect"] = std::string(effectName(*f.mend));
        list.push_back(std::move(one));
    }
    Json answer{{"fits", findings.empty()}, {"leaves", std::move(list)}};
    if (const auto mend = mendOf(findings)) {
        Json command{{"do", "enable"}, {"effect", std::string(effectName(*mend))}};
        if (effectDescriptor(*mend).canBeAutomatic) command["auto"] = true;
        const EffectCost cost = effectCost(access.document(), access.responses, *mend);
        answer["mend"] = {{"command", std::move(command)}, {"ms_per_frame", cost.milliseconds}, {"precompute", cost.precompute}};
    } else if (!findings.empty()) {
        answer["mend"] = {{"command", {{"do", "set"}, {"target", "character"}, {"property", "basis"}, {"value", "affine"}}}, {"precompute", true}};
    }
    return answer;
}

}  // namespace

void addPoseCheckCommands(CommandRegistry& registry) {
    registry.addAction("check-pose",
                       "Whether the elements can show the present pose: which fold, cross a joint, lose volume (more than 2 %), crease or lose their twist, and the command that mends it, with its price.",
                       {}, checkPoseCommand);
}

}  // namespace imomushi
