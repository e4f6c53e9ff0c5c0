// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>

#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/input_mapping.h"
#include "core/document/names.h"
#include "core/session/document_edit.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

constexpr double kTimeRoom = 1e-6;  // s: times this near to each other are the same, as sums of frames are not exact
constexpr double kLatest = 1e9;     // s

Result<void> checkTakeName(const Document& document, const std::string& name) {
    if (auto ok = checkNameText(name); !ok) return ok;
    if (document.takeNamed(name)) return fail("name-taken", "There is a take \"" + name + "\" already: choose another name, or remove that one first.");
    return {};
}

Json takeJson(const Take& take) {
    return Json{{"take", take.name}, {"frames", take.times.size()}, {"seconds", take.duration()}, {"bytes", take.bytes()}};
}

Result<Json> record(SessionAccess& access, const Json& arguments, const Progress&) {
    const auto& recording = access.live.recording();
    const std::string &name = text(arguments, "take"), &action = text(arguments, "action");
    if (action == "start") {
        if (recording) return fail("already-recording", "The take \"" + recording->take.name + "\" is being recorded: stop that first.");
        if (auto ok = checkTakeName(access.document(), name); !ok) return tl::unexpected(ok.error());
        if (auto started = access.live.startRecording(name); !started) return tl::unexpected(started.error());
        access.note(arguments);
        return Json{{"take", name}};
    }
    if (action != "stop") return fail("bad-value", "\"action\" must be \"start\" or \"stop\".");
    if (!recording) return fail("not-recording", "Nothing is being recorded: start first.");
    if (recording->take.name != name) return fail("not-recording", "\"" + recording->take.name + "\" is being recorded, not \"" + name + "\".");
    const bool whole = recording->going;
    Take made = access.live.recordedTake();
    made.name = freeTakeName(access.document(), name);  // another take may have got it meanwhile
    const auto take = access.addTake(std::move(made), arguments);
    access.live.endRecording();  // it goes on where memory ran out
    Json answer = takeJson(*take);
    answer["whole"] = whole;
    answer["warnings"] = Json::array();
    if (take->name != name) answer["warnings"].push_back("Another take got the name \"" + name + "\" meanwhile: this one is \"" + take->name + "\".");
    if (!whole) answer["warnings"].push_back("The recording ended early: the character changed while it was recorded, or the take was full.");
    return answer;
}

Result<Json> play(SessionAccess& access, const Json& arguments, const Progress& progress) {
    const auto& recording = access.live.recording();
    IMOMUSHI_TRY(const auto take, takeOf(access.document(), text(arguments, "take")));
    if (recording) return fail("already-recording", "The take \"" + recording->take.name + "\" is being recorded: stop that first.");
    const Take& t = *take;
    std::vector<double> times = t.times, milliseconds;
    if (const Json* time = find(arguments, "time")) {
        IMOMUSHI_TRY(const auto given, numberWithin(*time, "time", 0.0, t.duration() + kTimeRoom));
        times = {given};
    }
    bool exact = true;
    for (const double time : times) {
        if (progress.cancelled()) return fail(kCancelled, "Playing was cancelled.");
        const auto start = std::chrono::steady_clock::now();
        IMOMUSHI_TRY(const auto shown, access.live.showTake(t, time));
        milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        exact = exact && shown;
    }
    access.changedPose();
    Json answer{{"time", times.back()}, {"frames", t.times.size()}, {"seconds", t.duration()}, {"exact", exact}};
    answer["ms_per_frame"] = summary(std::move(milliseconds));
    answer["warnings"] = Json::array();
    if (!exact)
        answer["warnings"].push_back("The character is not what it was when \"" + t.name + "\" was recorded: its poses are shown without what effects added.");
    return answer;
}

Result<Json> renameTake(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto take, takeOf(edit.document, text(arguments, "take")));
    const std::string& name = text(arguments, "name");
    if (name == take->name) return Json::object();
    if (auto ok = checkTakeName(edit.document, name); !ok) return tl::unexpected(ok.error());
    const std::string before = take->name;
    exchangePart(edit.document.takes, take->id, [&](Take& t) { t.name = name; });
    renameMapped(edit.document, "take", before, name);
    return Json::object();
}

Result<Json> duplicateTake(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto take, takeOf(edit.document, text(arguments, "take")));
    const std::string& name = text(arguments, "name");
    if (auto ok = checkTakeName(edit.document, name); !ok) return tl::unexpected(ok.error());
    Document& document = edit.document;
    Take copy = *take;
    copy.id = document.nextId++;
    copy.name = name;
    const Json answer = takeJson(copy);
    document.takes.emplace(copy.id, std::make_shared<const Take>(std::move(copy)));
    return answer;
}

Result<Json> trimTake(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto take, takeOf(edit.document, text(arguments, "take")));
    const std::vector<double>& times = take->times;
    double from = 0.0, to = take->duration();
    for (const auto& [key, value] : {std::pair("from", &from), std::pair("to", &to)})
        if (const Json* time = find(arguments, key)) {
            IMOMUSHI_TRY(const auto given, numberWithin(*time, key, 0.0, kLatest));
            // Times after the end are the end: nothing is left out there.
            *value = std::min(given, take->duration());
        }
    const auto first = std::lower_bound(times.begin(), times.end(), from - kTimeRoom), last = std::upper_bound(times.begin(), times.end(), to + kTimeRoom);
    if (first >= last) return fail("bad-value", "No frame of the take lies between \"from\" and \"to\": choose times farther apart.");
    auto kept = std::make_shared<const Take>(takePart(*take, static_cast<std::size_t>(first - times.begin()), static_cast<std::size_t>(last - first)));
    const Json answer = takeJson(*kept);
    edit.document.takes.at(kept->id) = std::move(kept);
    return answer;
}

Result<Json> removeTake(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto take, takeOf(edit.document, text(arguments, "take")));
    edit.document.takes.erase(take->id);
    return Json::object();
}

}  // namespace

void addTakeCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey take{"take", Type::Text, true, "The take."};
    registry.addAction("record",
                       "Records a take: what is shown when it starts, and each frame that is stepped until it stops. Stopping is one step of the history.",
                       {{"take", Type::Text, true, "Its name, which no other take has."}, {"action", Type::Text, true, "\"start\" or \"stop\"."}},
                       record);
    registry.addAction("play",
                       "Shows a take as it was seen, until a frame is stepped or the pose is changed; what is held and posed stays as it is.",
                       {take, {"time", Type::Number, false, "Seconds from its start, between frames too; without it the whole take is stepped, to its end."}},
                       play);
    registry.addChange("rename-take", "Gives a take another name.", {take, {"name", Type::Text, true, "A name that no other take has."}}, renameTake);
    registry.addChange("duplicate-take", "Makes a copy of a take.", {take, {"name", Type::Text, true, "A name that no other take has."}}, duplicateTake);
    registry.addChange("trim-take",
                       "Keeps the frames of a take between two times, these included; they begin at 0 again.",
                       {take, {"from", Type::Number, false, "Seconds from its start (0)."}, {"to", Type::Number, false, "Seconds from its start (its end)."}},
                       trimTake);
    registry.addChange("remove-take", "Removes a take.", {take}, removeTake);
}

}  // namespace imomushi
