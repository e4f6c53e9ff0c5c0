// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/command_support.h"
#include "core/document/session_state.h"

namespace imomushi {

namespace {

Result<Json> move(Session& session, const Json& arguments, bool back) {
    Session::State& s = session.state();
    int count = 1;
    if (const Json* given = find(arguments, "count")) {
        if (auto ok = numberWithin(*given, "count", 1, 1e9); !ok) return tl::unexpected(ok.error());
        count = integer(*given);
    }
    if (s.gesture && back) {  // undo in the middle of a drag takes the drag back
        session.cancelGesture();
        return Json{{"undone", Json::array()}, {"position", s.position}};
    }
    session.endGesture();
    const auto steps = back ? s.undo(count) : s.redo(count);
    if (!steps) return tl::unexpected(steps.error());
    Json names = Json::array();
    for (const auto& step : *steps) names.push_back(step.name);
    return Json{{back ? "undone" : "redone", std::move(names)}, {"position", s.position}};
}

}  // namespace

void addHistoryCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey count{"count", Type::Integer, false, "How many steps (1 unless given)."};
    registry.add({"undo", "Takes back the last command that changed the document.", {count}, false,
                  [](Session& session, const Json& arguments, const Progress&) { return move(session, arguments, true); }});
    registry.add({"redo", "Does again what was taken back.", {count}, false,
                  [](Session& session, const Json& arguments, const Progress&) { return move(session, arguments, false); }});
}

}  // namespace imomushi
