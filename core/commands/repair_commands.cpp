// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/core_commands.h"
#include "core/document/character_repair.h"
#include "core/document/command_support.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

Json issuesJson(const std::vector<MeshIssue>& issues) {
    Json lines = Json::array();
    for (const MeshIssue& issue : issues) lines.push_back(issueJson(issue));
    return lines;
}

Result<Json> repair(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    IMOMUSHI_TRY(const auto request, mendRequestFrom(arguments));
    const std::string& target = text(arguments, "element");
    Result<MendReport> report;
    if (const CharacterSource* whole = edit.document.characterNamed(target)) {
        report = mendCharacter(edit.document, whole->id, request, edit.services.makeBody, progress);
    } else {
        IMOMUSHI_TRY(const auto element, elementOf(edit.document, target));
        report = mendElement(edit.document, element->id, request, edit.services.makeBody, progress);
    }
    if (!report) return tl::unexpected(report.error());

    const Document& document = edit.document;
    Json answer{{"before", issuesJson(report->before)}, {"after", issuesJson(report->after)}, {"done", Json::array()}, {"unneeded", Json::array()}};
    for (const MeshIssue& issue : report->done) {
        const auto action = repairFor(issue.code);
        Json line{{"action", action ? Json(nameOf(*action)) : Json()}};
        line.update(issueJson(issue));
        answer["done"].push_back(std::move(line));
    }
    for (const RepairAction action : report->unneeded) answer["unneeded"].push_back(nameOf(action));
    if (report->character != 0) {
        const CharacterSource& character = *document.characters.at(report->character);
        answer["character"] = character.name;
        answer["body"] = bodyJson(*character.body);
    }
    Json stale = Json::array();
    for (const PartId id : report->changed) stale.push_back(document.elements.at(id)->name);
    answer["stale"] = std::move(stale);
    return answer;
}

}  // namespace

void addRepairCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("repair",
                       "Mends the body of an element or of a whole character; what is seen stays as it is. Answers with the issues before and after. An element of its own becomes a "
                       "character if there is something to mend. One that was imported unmended keeps the wrap around it until nothing is left to mend. Cuts, handles and bones stay, and joint "
                       "faces where the body does.",
                       {{"element", Type::Text, true, "The element, or a character."},
                        {"actions", Type::Array, false,
                         "Which steps: \"weld\", \"drop\" (triangles without area, copies, unused vertices), \"separate\" (what meets in crowded edges or single vertices), \"orient\", \"fill\" (holes), "
                         "\"wrap\" (a new surface around all). Those that mend the issues there are unless given, a wrap last and only where nothing else helps."},
                        {"detail", Type::Number, false, "Of a wrap, in diagonals of the mesh: gaps narrower than twice this are closed (0.001 to 0.2; chosen from the mesh unless given)."}},
                       repair);
}

}  // namespace imomushi
