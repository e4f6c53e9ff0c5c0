// SPDX-License-Identifier: GPL-3.0-or-later
// What live input drives: the table of mappings.
#include "core/commands/mapping_commands.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "core/base/atomic_file.h"
#include "core/commands/core_commands.h"
#include "core/document/command_support.h"
#include "core/document/input_mapping.h"
#include "core/live/suggested_mappings.h"
#include "core/session/document_edit.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

InputMappings mappingsOf(const Document& document) { return document.mappings ? *document.mappings : InputMappings(); }

Result<Json> mapInput(DocumentEdit& edit, const Json& arguments, const Progress&) {
    InputMappings mappings = mappingsOf(edit.document);
    // What is not said of a line that is there stays.
    Json asked = arguments;
    asked.erase("do");
    asked.erase("position");
    IMOMUSHI_TRY(InputMapping made, mappingFrom(asked));
    for (const InputMapping& known : mappings)
        if (known.sameLine(made)) {
            Json merged = mappingJson(known);
            merged.update(asked);
            IMOMUSHI_TRY(made, mappingFrom(merged));
            break;
        }
    if (auto there = mappedTarget(edit.document, made.target); !there) return tl::unexpected(there.error());
    std::optional<std::size_t> place;
    if (const Json* given = find(arguments, "position")) {
        IMOMUSHI_TRY(const auto position, numberWithin(*given, "position", 0, InputMapping::kMost));
        place = static_cast<std::size_t>(position);
    }
    IMOMUSHI_TRY(const auto at, putMapping(mappings, std::move(made), place));
    const std::size_t count = mappings.size();
    setMappings(edit.document, std::move(mappings));
    return Json{{"position", at}, {"mappings", count}};
}

Result<Json> suggestMappings(DocumentEdit& edit, const Json& arguments, const Progress&) {
    const auto protocol = protocolNamed(text(arguments, "protocol"));
    if (protocol != InputProtocol::Pad && protocol != InputProtocol::Keys && protocol != InputProtocol::Vmc && protocol != InputProtocol::Voice) return fail("bad-value", "\"protocol\" must be \"pad\", \"keys\", \"voice\" or \"vmc\": senders of others have no names in common.");
    const std::string source = arguments.contains("source") ? text(arguments, "source") : std::string(protocolName(*protocol));
    if (source.empty() || !InputName::fits(source)) return fail("bad-value", "\"source\" must be a short text.");
    IMOMUSHI_TRY(const auto plan, edit.planned());
    InputMappings mappings = mappingsOf(edit.document), suggested = suggestedMappings(edit.document, *plan, *protocol, source);
    if (std::ranges::none_of(suggested, [](const InputMapping& m) { return !m.target.starts_with("trigger/"); }))
        return fail("nothing-to-drive", "The character has nothing that could be driven so: give it bones whose ends are free, handles or morph targets.");
    std::erase_if(mappings, [&](const InputMapping& m) { return m.row.source == source; });
    Json rows = mappingsJson(suggested);
    for (InputMapping& mapping : suggested)
        if (auto ok = putMapping(mappings, std::move(mapping)); !ok) return tl::unexpected(ok.error());
    Json answer{{"suggested", rows.size()}, {"mappings", mappings.size()}, {"rows", std::move(rows)}};
    setMappings(edit.document, std::move(mappings));
    return answer;
}

Result<Json> unmapInput(DocumentEdit& edit, const Json& arguments, const Progress&) {
    InputMappings mappings = mappingsOf(edit.document);
    const auto asked = [&](const char* key, const std::string& is) {
        const Json* given = find(arguments, key);
        return !given || *given == is;
    };
    const Json* component = find(arguments, "component");
    const std::size_t removed = std::erase_if(mappings, [&](const InputMapping& m) {
        return asked("source", m.row.source) && asked("channel", m.row.channel) && asked("target", m.target) && (!component || *component == m.row.component);
    });
    if (removed == 0) return fail("not-mapped", "There is no such mapping; \"list\" shows all.");
    const std::size_t count = mappings.size();
    setMappings(edit.document, std::move(mappings));
    return Json{{"removed", removed}, {"mappings", count}};
}

Result<Json> saveMappings(SessionAccess& access, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    const InputMappings mappings = mappingsOf(access.document());
    if (auto written = writeFileAtomically(path, mappingsText(mappings)); !written) return tl::unexpected(written.error());
    return Json{{"mappings", mappings.size()}};
}

Result<Json> loadMappings(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return fail("file-not-found", "There is no file \"" + path.string() + "\": check its path.");
    std::ifstream file(path, std::ios::binary);
    if (!std::filesystem::is_regular_file(path, error) || !file) return fail("not-readable", "\"" + path.string() + "\" cannot be read: check its permissions.");
    std::string text(kMostMappingBytes + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    IMOMUSHI_TRY(auto loaded, mappingsFromText(text));
    InputMappings mappings = mappingsOf(edit.document);
    Json missing = Json::array();
    const std::size_t count = loaded.size();
    for (InputMapping& mapping : loaded) {
        if (!mappedTarget(edit.document, mapping.target)) missing.push_back(mapping.target);
        if (auto ok = putMapping(mappings, std::move(mapping)); !ok) return tl::unexpected(ok.error());
    }
    Json answer{{"loaded", count}, {"mappings", mappings.size()}, {"missing", std::move(missing)}};
    setMappings(edit.document, std::move(mappings));
    return answer;
}

}  // namespace

Json shownMappings(const Document& document) {
    Json list = mappingsJson(*document.mappings);
    for (Json& line : list)
        if (!mappedTarget(document, text(line, "target"))) line["missing"] = true;
    return list;
}

void addMappingCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("map-input",
                       "Lets a number of live input drive a number of the character, or changes how it does: a row of the table of mappings. Of rows with one target the first one wins that is heard. "
                       "A line is known by source, channel, component and target; of one that is there, keys left out stay as they are.",
                       {{"source", Type::Text, true, "Who sends it, as \"live\" calls it: \"osc\", \"vmc\", \"pad\", \"midi\", \"keys\", \"voice\", or another name."},
                        {"channel", Type::Text, true, "What it is called there: an OSC address, \"blend/Joy\" of VMC, \"cc/1/7\" of MIDI, \"left-x\" of a pad, \"space\" of the keyboard, \"level\" or \"aa\" of a microphone."},
                        {"component", Type::Integer, false, "Which number of the channel, from 0 (0)."},
                        {"target", Type::Text, true, "What it drives: \"handle/NAME/x\" (y, z: metres from rest; turn-x, turn-y, turn-z: radians), \"bone/NAME/end/x\" (or start; y, z; roll), \"bone/NAME/turn-x\" (y, z: radians from rest about its parent, by forward kinematics), \"morph/CHARACTER/NAME\" (its weight), \"pose/NAME/weight\" (how much of a kept pose, 0 to 1), \"cycle/NAME/amount\" (how much of a cycle, 0 to 1), \"cycle/NAME/speed\" (1: as it was made, below 0 backwards), \"effect/NAME/PROPERTY\" (in its unit; of a vector \"effect/NAME/PROPERTY/x\", y, z). Or what it lets happen when it passes the middle of its range: \"take/NAME/play\", \"take/NAME/stop\" (in the studio), \"trigger/let-go\" (everything that inputs move glides to rest)."},
                        {"in", Type::Array, false, "The range of the control [low, high] ([0,1]); values beyond are at its ends. One that has 0 within has its middle there."},
                        {"out", Type::Array, false, "What the ends become, in the unit of the target (as \"in\"); the first may be the larger one."},
                        {"exponent", Type::Number, false, "Of the curve, 1/16 to 16: 1 straight, more is finer near the beginning or the middle (1)."},
                        {"dead_zone", Type::Number, false, "Part of the range next to its beginning or middle that counts as that, 0 to 0.99 (0)."},
                        {"hertz", Type::Number, false, "Smoothing by a one-euro filter: the cutoff of what stands still, 0 none (0)."},
                        {"reaction", Type::Number, false, "How much the cutoff rises with the speed of the control, Hz per unit and second (0)."},
                        {"silence", Type::Text, false, "What happens where its source falls silent: \"hold\", \"rest\" (it glides there) or \"next\" (the next row of the target drives it) (hold)."},
                        {"after", Type::Number, false, "Seconds after which a source counts as silent, up to 3600; 0: never (0)."},
                        {"mute", Type::Boolean, false, "It drives nothing (false)."},
                        {"toggle", Type::Boolean, false, "A press puts it at the end of its range, the next one at the beginning again (false). A press passes the middle of the range upwards."},
                        {"spring", Type::Number, false, "Hz, up to 20: what it drives hangs on a spring, swings beyond and comes to rest; 0: none (0)."},
                        {"spring_damping", Type::Number, false, "Damping ratio of the spring, 0.05 to 1 (1: it does not swing beyond) (0.4)."},
                        {"mirror", Type::Boolean, false, "The same part of the other side, by its name (.L and .R, left and right), does the same, mirrored in x, unless a row of its own is heard (false)."},
                        {"solo", Type::Boolean, false, "Rows that are not solo are muted (false)."},
                        {"position", Type::Integer, false, "Its place in the table, from 0 (where it is, a new one at the end)."}},
                       mapInput);
    registry.addChange("unmap-input", "Removes mappings: those that all the given keys name; all without keys.",
                       {{"source", Type::Text, false, "Of this source alone."}, {"channel", Type::Text, false, "Of this channel alone."}, {"component", Type::Integer, false, "Of this number alone."}, {"target", Type::Text, false, "Of this target alone."}}, unmapInput);
    registry.addChange("suggest-mappings",
                       "Maps a game controller, the keyboard, a microphone or a body and face by VMC to whatever the character has: sticks move the limbs that reach farthest to both sides, and the highest one; triggers of a controller have how much there is of the first cycle and how fast it runs, where there are cycles; buttons show kept poses or morph targets; "
                       "bones turn by their roles of a human; without roles the head of who performs turns the highest limb, the arms turn those of both sides; values of a face and vowels of a voice move morph targets. All rows of this source that were there go. \"rows\": as map-input takes them.",
                       {{"protocol", Type::Text, true, "\"pad\", \"keys\", \"voice\" or \"vmc\"."}, {"source", Type::Text, false, "Who sends it (the protocol)."}}, suggestMappings);
    registry.addAction("save-mappings", "Writes the table of mappings into a file, for other projects.", {{"path", Type::Text, true, "The file, JSON."}}, saveMappings);
    registry.addChange("load-mappings", "Adds the mappings of a file; lines that are there become those of the file. \"missing\": targets that are not there, whose rows wait for them.",
                       {{"path", Type::Text, true, "A file that save-mappings made."}}, loadMappings);
}

}  // namespace imomushi
