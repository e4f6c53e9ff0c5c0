// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/command_support.h"
#include "core/document/session_access.h"

namespace imomushi {

namespace {

Result<Json> move(SessionAccess& access, const Json& arguments, bool back) {
    int count = 1;
    if (const Json* given = find(arguments, "count")) {
        if (auto ok = numberWithin(*given, "count", 1, 1e9); !ok) return tl::unexpected(ok.error());
        count = integer(*given);
    }
    const auto steps = back ? access.undo(count) : access.redo(count);
    if (!steps) return tl::unexpected(steps.error());
    Json names = Json::array();
    for (const auto& step : *steps) names.push_back(step.name);
    return Json{{back ? "undone" : "redone", std::move(names)}, {"position", access.session.position()}};
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
