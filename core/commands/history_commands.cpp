// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

Result<Json> move(SessionAccess& access, const Json& arguments, bool back) {
    int count = 1;
    if (const Json* given = find(arguments, "count")) {
        if (auto ok = numberWithin(*given, "count", 1, 1e9); !ok) return tl::unexpected(ok.error());
        count = integer(*given);
    }
    // The answer is made first: nothing may fail once the step is done.
    const auto& steps = access.session.steps();
    const int position = access.session.position();
    Json names = Json::array();
    for (int i = 0; i < count; ++i) {
        const int step = back ? position - 1 - i : position + i;
        if (step < 0 || step >= static_cast<int>(steps.size())) break;
        names.push_back(steps[static_cast<std::size_t>(step)].name);
    }
    const char* done = back ? "undone" : "redone";
    Json answer{{done, std::move(names)}, {"position", back ? position - count : position + count}}, ofGesture{{done, Json::array()}, {"position", position}};
    IMOMUSHI_TRY(const auto moved, back ? access.undo(count) : access.redo(count));
    return moved ? std::move(answer) : std::move(ofGesture);
}

}  // namespace

void addHistoryCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey count{"count", Type::Integer, false, "How many steps (1 unless given)."};
    registry.addAction("undo", "Takes back the last command that changed the document.", {count},
                       [](SessionAccess& access, const Json& arguments, const Progress&) { return move(access, arguments, true); });
    registry.addAction("redo", "Does again what was taken back.", {count},
                       [](SessionAccess& access, const Json& arguments, const Progress&) { return move(access, arguments, false); });
}

}  // namespace imomushi
