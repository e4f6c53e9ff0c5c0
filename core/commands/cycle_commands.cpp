// SPDX-License-Identifier: GPL-3.0-or-later
// Cycles: movements that repeat through kept poses.
#include <algorithm>
#include <map>
#include <set>

#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/cycle.h"
#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "core/document/names.h"
#include "core/document/source_calibration.h"
#include "core/live/suggested_cycles.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// Errors: "no-such-cycle" with the names there are.
Result<Cycles::const_iterator> cycleIn(const Cycles& cycles, const std::string& name) {
    const auto found = std::ranges::find(cycles, name, &Cycle::name);
    if (found != cycles.end()) return found;
    std::vector<std::string> there;
    for (const Cycle& cycle : cycles) there.push_back(cycle.name);
    return fail("no-such-cycle", "There is no cycle \"" + name + "\"" + (there.empty() ? "; make one by add-cycle." : "; " + listNames(there) + "."));
}

/// Live input calls it by its name.
Result<void> checkCycleName(const std::string& name) {
    if (auto ok = checkNameText(name); !ok) return ok;
    if (!InputName::fits("/imomushi/cycle/" + name + "/amount")) return fail("bad-name", "The name \"" + name + "\" is too long to be performed: choose a shorter one.");
    return {};
}

std::string freeCycleName(const Document& document) {
    for (int n = 1;; ++n)
        if (std::string name = "cycle " + std::to_string(n); !cycleNamed(document, name)) return name;
}

Result<std::vector<std::string>> cyclePoses(const Document& document, const Json& list) {
    std::vector<std::string> names;
    for (const Json& name : list) {
        if (!name.is_string()) return fail("bad-type", "\"poses\" must be names of kept poses.");
        names.push_back(name.get<std::string>());
        if (!keptPose(document, names.back())) return fail("no-such-pose", "There is no pose \"" + names.back() + "\": keep it by keep-pose first.");
    }
    if (names.size() < Cycle::kFewestPoses || names.size() > Cycle::kMostPoses)
        return fail("cycle-poses", "A cycle goes through " + std::to_string(Cycle::kFewestPoses) + " to " + std::to_string(Cycle::kMostPoses) + " kept poses: name as many.");
    return names;
}

Result<Json> addCycle(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Cycles cycles = cyclesOf(edit.document);
    const std::string name = arguments.contains("name") ? text(arguments, "name") : freeCycleName(edit.document);
    if (auto ok = checkCycleName(name); !ok) return tl::unexpected(ok.error());
    const auto same = std::ranges::find(cycles, name, &Cycle::name);
    const bool replaced = same != cycles.end();
    Cycle made = replaced ? *same : Cycle{name, {}, {}};
    if (!replaced) made.seconds = Cycle().seconds;
    if (const Json* poses = find(arguments, "poses")) {
        IMOMUSHI_TRY(made.poses, cyclePoses(edit.document, *poses));
    } else if (!replaced) {
        return fail("missing-key", "A new cycle needs \"poses\": names of kept poses.");
    }
    if (auto ok = readNumber(arguments, "seconds", Cycle::kShortest, Cycle::kLongest, made.seconds); !ok) return tl::unexpected(ok.error());
    if (replaced) *same = std::move(made);
    else if (cycles.size() >= Cycle::kMost) return fail("too-many-cycles", "There are " + std::to_string(Cycle::kMost) + " cycles already: remove some.");
    else cycles.push_back(std::move(made));
    Json answer{{"name", name}, {"replaced", replaced}, {"cycles", cycles.size()}};
    setCycles(edit.document, std::move(cycles));
    return answer;
}

Result<Json> renameCycle(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Cycles cycles = cyclesOf(edit.document);
    IMOMUSHI_TRY(const auto cycle, cycleIn(cycles, text(arguments, "cycle")));
    const std::string& name = text(arguments, "name");
    if (name == cycle->name) return Json::object();
    if (auto ok = checkCycleName(name); !ok) return tl::unexpected(ok.error());
    if (cycleNamed(edit.document, name)) return fail("name-taken", "There is a cycle \"" + name + "\" already: choose another name.");
    renameMapped(edit.document, "cycle", cycle->name, name);
    cycles[std::size_t(cycle - cycles.cbegin())].name = name;
    setCycles(edit.document, std::move(cycles));
    return Json::object();
}

Result<Json> removeCycle(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Cycles cycles = cyclesOf(edit.document);
    IMOMUSHI_TRY(const auto cycle, cycleIn(cycles, text(arguments, "cycle")));
    const std::set<std::string> through(cycle->poses.begin(), cycle->poses.end());
    cycles.erase(cycle);
    setCycles(edit.document, std::move(cycles));
    Json removed = Json::array();
    std::set<std::string> uncalibrated;
    if (arguments.value("poses", false)) {
        KeptPoses poses = keptPoses(edit.document);
        std::erase_if(poses, [&](const KeptPose& pose) {
            const bool goes = through.contains(pose.name) && cyclesThrough(edit.document, pose.name).empty();
            if (goes) removed.push_back(pose.name);
            return goes;
        });
        for (const Json& pose : removed)
            for (std::string& source : dropPoseFromCalibrations(edit.document, pose.get<std::string>())) uncalibrated.insert(std::move(source));
        if (!removed.empty()) setKeptPoses(edit.document, std::move(poses));
    }
    Json answer{{"removed_poses", std::move(removed)}};
    if (!uncalibrated.empty()) answer["uncalibrated"] = uncalibrated;
    return answer;
}

/// Suggested cycles get other names, and so do their poses.
Result<void> renameSuggested(std::vector<SuggestedCycle>& suggested, const Json& names) {
    std::map<std::string, std::string> called{{"crawl", "crawl"}, {"sway", "sway"}, {"breathe", "breathe"}};
    for (const auto& [kind, name] : names.items()) {
        if (!called.contains(kind)) return fail("unknown-key", "\"names\" has names for \"crawl\", \"sway\" and \"breathe\", not for \"" + kind + "\".");
        if (!name.is_string()) return fail("bad-type", "\"names\" must have texts.");
        if (auto ok = checkCycleName(name.get<std::string>()); !ok) return ok;
        called[kind] = name.get<std::string>();
    }
    std::set<std::string> taken;
    for (const auto& [kind, name] : called)
        if (!taken.insert(name).second) return fail("name-taken", "Two cycles would be called \"" + name + "\": choose different names.");
    for (SuggestedCycle& made : suggested) {
        made.cycle.name = called.at(made.cycle.name);
        for (std::size_t p = 0; p < made.poses.size(); ++p) made.poses[p].name = made.cycle.poses[p] = made.cycle.name + " " + std::to_string(p + 1);
    }
    return {};
}

Result<Json> suggestCycles(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto plan, edit.planned());
    std::vector<SuggestedCycle> suggested = suggestedCycles(edit.document, *plan);
    if (const Json* names = find(arguments, "names"))
        if (auto ok = renameSuggested(suggested, *names); !ok) return tl::unexpected(ok.error());
    if (suggested.empty()) return fail("nothing-to-cycle", "The character has nothing that could move by itself: give it bones or handles first.");
    Cycles cycles = cyclesOf(edit.document);
    KeptPoses poses = keptPoses(edit.document);
    const auto put = [](auto& all, auto&& made) {
        const auto same = std::ranges::find_if(all, [&](const auto& known) { return known.name == made.name; });
        same == all.end() ? void(all.push_back(std::move(made))) : void(*same = std::move(made));
    };
    Json answer{{"cycles", Json::array()}, {"poses", Json::array()}};
    for (SuggestedCycle& made : suggested) {
        answer["cycles"].push_back(made.cycle.name);
        for (KeptPose& pose : made.poses) {
            answer["poses"].push_back(pose.name);
            put(poses, std::move(pose));
        }
        put(cycles, std::move(made.cycle));
    }
    if (cycles.size() > Cycle::kMost) return fail("too-many-cycles", "There are too many cycles already: remove some.");
    if (poses.size() > kMostKeptPoses) return fail("too-many-poses", "There are too many poses already: remove some.");
    setKeptPoses(edit.document, std::move(poses));
    setCycles(edit.document, std::move(cycles));
    return answer;
}

}  // namespace

void addCycleCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("add-cycle", "Makes a movement that repeats through kept poses, evenly in time and smoothly, from the last one on to the first one again. Live input performs it: \"cycle/NAME/amount\" of map-input says how much of it there is, \"cycle/NAME/speed\" how fast it runs. Of one of that name, keys left out stay.",
                       {{"name", Type::Text, false, "Its name (\"cycle 1\", ...)."},
                        {"poses", Type::Array, false, "Names of 2 to 64 kept poses, in their order; one may come several times. Three meet a wave exactly."},
                        {"seconds", Type::Number, false, "How long one round takes at speed 1, 0.05 to 3600 (2)."}},
                       addCycle);
    registry.addChange("suggest-cycles", "Makes cycles and their kept poses from the skeleton: \"crawl\" (chains of three bones and more that lie near the ground rise and fall in waves from root to tip), \"sway\" (limbs and tails swing to the side, legs stand) and \"breathe\" (the body gets a little longer; without bones, handles rise). Cycles and poses of these names are replaced.",
                       {{"names", Type::Object, false, "Other names, by \"crawl\", \"sway\" or \"breathe\". Their poses are called so with a number."}}, suggestCycles);
    registry.addChange("rename-cycle", "Renames a cycle; mappings follow.", {{"cycle", Type::Text, true, "Its name."}, {"name", Type::Text, true, "A name that no cycle has."}}, renameCycle);
    registry.addChange("remove-cycle", "Removes a cycle.", {{"cycle", Type::Text, true, "Its name."}, {"poses", Type::Boolean, false, "With the kept poses that no other cycle goes through (false). Calibrations lose them (\"uncalibrated\" in the answer: of these sources)."}}, removeCycle);
}

}  // namespace imomushi
