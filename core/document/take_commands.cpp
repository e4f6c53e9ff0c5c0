// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>

#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/session_state.h"

namespace imomushi {

namespace {

constexpr double kTimeRoom = 1e-6;  // s: a time this much after the end is the end, as sums of frames are not exact

Result<void> checkTakeName(const Document& document, const std::string& name) {
    if (auto ok = checkNameText(name); !ok) return ok;
    if (document.takeNamed(name)) return fail("name-taken", "There is a take \"" + name + "\" already: choose another name, or remove that one first.");
    return {};
}

Json takeJson(const Take& take) {
    return Json{{"take", take.name}, {"frames", take.times.size()}, {"seconds", take.duration()}, {"bytes", take.bytes()}};
}

Result<Json> record(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    const std::string &name = text(arguments, "take"), &action = text(arguments, "action");
    if (action == "start") {
        if (s.recording) return fail("already-recording", "The take \"" + s.recording->take.name + "\" is being recorded: stop that first.");
        if (auto ok = checkTakeName(s.document, name); !ok) return tl::unexpected(ok.error());
        if (auto started = s.startRecording(name, arguments); !started) return tl::unexpected(started.error());
        return Json{{"take", name}};
    }
    if (action != "stop") return fail("bad-value", "\"action\" must be \"start\" or \"stop\".");
    if (!s.recording) return fail("not-recording", "Nothing is being recorded: start first.");
    if (s.recording->take.name != name) return fail("not-recording", "\"" + s.recording->take.name + "\" is being recorded, not \"" + name + "\".");
    const bool whole = s.recording->going;
    const auto take = s.stopRecording(arguments);
    Json answer = takeJson(*take);
    answer["whole"] = whole;
    answer["warnings"] = Json::array();
    if (!whole) answer["warnings"].push_back("The recording ended early: the character changed while it was recorded, or the take was full.");
    return answer;
}

Result<Json> play(Session& session, const Json& arguments, const Progress& progress) {
    Session::State& s = session.state();
    const auto take = takeOf(s.document, text(arguments, "take"));
    if (!take) return tl::unexpected(take.error());
    if (s.recording) return fail("already-recording", "The take \"" + s.recording->take.name + "\" is being recorded: stop that first.");
    const Take& t = **take;
    std::vector<double> times = t.times, milliseconds;
    if (const Json* time = find(arguments, "time")) {
        const auto given = numberWithin(*time, "time", 0.0, t.duration() + kTimeRoom);
        if (!given) return tl::unexpected(given.error());
        times = {*given};
    }
    bool exact = true;
    for (const double time : times) {
        if (progress.cancelled()) return fail(kCancelled, "Playing was cancelled.");
        const auto start = std::chrono::steady_clock::now();
        const auto shown = s.showTake(t, time);
        if (!shown) return tl::unexpected(shown.error());
        milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        exact = exact && *shown;
    }
    s.pending.pose = true;
    Json answer{{"time", times.back()}, {"frames", t.times.size()}, {"seconds", t.duration()}, {"exact", exact}};
    answer["ms_per_frame"] = summary(std::move(milliseconds));
    answer["warnings"] = Json::array();
    if (!exact)
        answer["warnings"].push_back("The character is not what it was when \"" + t.name + "\" was recorded: its poses are shown without what effects added.");
    return answer;
}

Result<Json> renameTake(Session& session, const Json& arguments, const Progress&) {
    const auto take = takeOf(session.document(), text(arguments, "take"));
    if (!take) return tl::unexpected(take.error());
    const std::string& name = text(arguments, "name");
    if (name == (*take)->name) return Json::object();
    if (auto ok = checkTakeName(session.document(), name); !ok) return tl::unexpected(ok.error());
    exchangePart(session.edit().takes, (*take)->id, [&](Take& t) { t.name = name; });
    return Json::object();
}

Result<Json> removeTake(Session& session, const Json& arguments, const Progress&) {
    const auto take = takeOf(session.document(), text(arguments, "take"));
    if (!take) return tl::unexpected(take.error());
    session.edit().takes.erase((*take)->id);
    return Json::object();
}

}  // namespace

void addTakeCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey take{"take", Type::Text, true, "The take."};
    registry.add({"record",
                  "Records a take: what is shown when it starts, and each frame that is stepped until it stops. Stopping is one step of the history.",
                  {{"take", Type::Text, true, "Its name, which no other take has."}, {"action", Type::Text, true, "\"start\" or \"stop\"."}},
                  false, record});
    registry.add({"play",
                  "Shows a take as it was seen, until a frame is stepped or the pose is changed; what is held and posed stays as it is.",
                  {take, {"time", Type::Number, false, "Seconds from its start, between frames too; without it the whole take is stepped, to its end."}},
                  false, play});
    registry.add({"rename-take", "Gives a take another name.", {take, {"name", Type::Text, true, "A name that no other take has."}}, true, renameTake});
    registry.add({"remove-take", "Removes a take.", {take}, true, removeTake});
}

}  // namespace imomushi
