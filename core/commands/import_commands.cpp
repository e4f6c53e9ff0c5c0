// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <utility>

#include "core/commands/core_commands.h"
#include "core/commands/import_request.h"
#include "core/document/attachments.h"
#include "core/document/character_cuts.h"
#include "core/document/character_repair.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/mesh/connectivity.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

Result<Json> importElement(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(auto request, importRequestFrom(document, arguments));
    request.split = arguments.value("split", false);

    IMOMUSHI_TRY(auto imported, edit.services.import(request, progress));
    const auto usable = std::count_if(imported.bodies.begin(), imported.bodies.end(), [](const ImportedBody& body) { return body.closed; });
    if (imported.bodies.empty()) return fail("empty-mesh", "\"" + request.path.string() + "\" holds no surface.");
    if (usable == 0) {
        const Error error = importRefusal(imported.bodies.front());
        return fail(error.code, error.message);
    }

    Json elements = Json::array(), issues = Json::array();
    for (const MeshIssue& issue : imported.issues) issues.push_back(issueJson(issue));
    for (ImportedBody& body : imported.bodies) {
        if (!body.closed) {
            issues.push_back({{"code", "left-out"}, {"text", importRefusal(body).message + " It was left out."}, {"count", 1}, {"fixed", false}, {"severity", "warning"}});
            continue;
        }
        Element element;
        element.id = document.nextId++;
        const Json* name = find(arguments, "name");
        element.name = freeName(document, name ? name->get_ref<const std::string&>() : body.name);
        element.issues = body.issues;
        element.mesh = std::make_shared<const ElementMesh>(std::move(body.mesh));
        const MeshFacts& facts = element.mesh->connectivity().facts();
        Json line{{"name", element.name}, {"vertices", element.mesh->body.vertices.rows()},
                  {"triangles", element.mesh->body.triangles.rows()}, {"closed", body.closed}, {"components", body.components},
                  {"volume", facts.volume}, {"size", json(facts.high - facts.low)}, {"low", json(facts.low)}, {"high", json(facts.high)}};
        elements.push_back(std::move(line));
        for (const MeshIssue& issue : body.issues) {
            Json told = issueJson(issue);
            told["element"] = element.name;
            issues.push_back(std::move(told));
        }
        document.elements.emplace(element.id, std::make_shared<const Element>(std::move(element)));
    }
    Json answer{{"elements", std::move(elements)}, {"issues", std::move(issues)}, {"format", imported.format},
                {"metres_per_unit", imported.metresPerUnit}, {"turned_z_up", imported.zUpConverted}};
    return answer;
}

/// "links" as bodyJson() tells them.
Result<std::vector<FleshLink>> linksFrom(const Json& given) {
    std::vector<FleshLink> links;
    for (const Json& line : given) {
        const auto end = [&](const char* key) { return line.is_object() && line.contains(key) ? vector3(line[key]) : std::nullopt; };
        const auto from = end("from"), to = end("to");
        if (!from || !to || !line.contains("radius")) return fail("bad-type", "Each of \"links\" needs \"from\" and \"to\", three numbers each, and \"radius\".");
        FleshLink link{*from, *to};
        IMOMUSHI_TRY(link.radius, numberWithin(line["radius"], "radius", 0.0, kMaxCoordinate));
        if (!(link.radius > 0.0)) return fail("bad-value", "The \"radius\" of a link must be more than 0: leave the link out to have none there.");
        links.push_back(link);
    }
    return links;
}

Result<Json> importCharacterCommand(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto request, importRequestFrom(document, arguments));
    BodySetting setting;
    using Kind = std::optional<BodyKind>;  // none: unmended
    IMOMUSHI_TRY(const auto how, choiceFrom<Kind>(arguments, "body", {{"auto", BodyKind::Auto}, {"exact", BodyKind::Exact}, {"mended", BodyKind::Mended}, {"wrapped", BodyKind::Wrapped}, {"unmended", Kind()}}, Kind(BodyKind::Auto)));
    setting.how = how.value_or(BodyKind::Wrapped);
    if (auto ok = readNumber(arguments, "detail", kFinestDetail, kCoarsestDetail, setting.detail); !ok) return tl::unexpected(ok.error());
    if (const Json* links = find(arguments, "links")) {
        if (!how || *how == BodyKind::Exact || *how == BodyKind::Wrapped) return fail("bad-value", "Only a mended body has \"links\": make \"body\" \"mended\" or \"auto\", or leave them out.");
        IMOMUSHI_TRY(setting.links, linksFrom(*links));
    }
    IMOMUSHI_TRY(auto imported, edit.services.importCharacter(request, progress.part(0.0, 0.3)));
    if (imported.renderModel.mesh.body.triangles.rows() == 0) return fail("empty-mesh", "\"" + request.path.string() + "\" holds no surface.");
    std::vector<MeshIssue> found;  // to be mended later, if anything is
    if (!how) found = mendableIssues(imported.renderModel);
    if (!how && found.empty()) setting.how = BodyKind::Auto;
    if (!found.empty() && setting.detail == 0.0) setting.detail = kPassingDetail;
    IMOMUSHI_TRY(auto body, edit.services.makeBody(imported.renderModel, imported.rig ? &*imported.rig : nullptr, setting, progress.part(0.3, 1.0)));

    CharacterSource character;
    character.id = document.nextId++;
    const Json* name = find(arguments, "name");
    character.name = freeName(document, name ? name->get_ref<const std::string&>() : imported.renderModel.parts.size() == 1 ? imported.renderModel.parts[0] : request.path.stem().string());
    std::vector<MeshIssue> said = std::move(body.report.issues);
    if (!found.empty()) std::erase_if(said, [](const MeshIssue& issue) { return issue.fixed; });  // a wrap alone mends nothing
    said.insert(said.begin(), found.begin(), found.end());
    character.issues = issuesWith(imported.issues, imported.renderModel, std::move(said));
    const double seconds = std::exchange(body.report.seconds, 0.0);  // the rest of the report is the same each time
    body.report.issues.clear();
    if (imported.rig) character.rig = std::make_shared<const Rig>(std::move(*imported.rig));
    character.model = std::make_shared<const RenderModel>(std::move(imported.renderModel));
    character.body = std::make_shared<const Body>(std::move(body));
    const auto added = document.characters.emplace(character.id, std::make_shared<const CharacterSource>(std::move(character))).first->second;
    Element element = wholeElement(*added);
    element.id = document.nextId++;
    element.name = freeName(document, added->name + " body");
    document.elements.emplace(element.id, std::make_shared<const Element>(std::move(element)));

    const Json line = characterJson(document, *added);
    Json answer;
    answer["characters"] = Json::array({line});
    answer["body"] = line["body"];
    answer["body"]["seconds"] = seconds;
    answer["parts"] = line["parts"];
    answer["elements"] = line["elements"];
    answer["skeleton"] = line["skeleton"];
    answer["clips"] = line["clips"];
    if (line.contains("avatar")) answer["avatar"] = line["avatar"];
    answer["issues"] = Json::array();
    for (const MeshIssue& issue : added->issues) answer["issues"].push_back(issueJson(issue));
    answer["format"] = imported.format;
    answer["metres_per_unit"] = imported.metresPerUnit;
    answer["turned_z_up"] = imported.zUpConverted;
    return answer;
}

}  // namespace

Json issueJson(const MeshIssue& issue) {
    const char* severity = issue.severity == Severity::Info ? "info" : issue.severity == Severity::Warning ? "warning" : "error";
    return Json{{"code", issue.code}, {"text", issue.text}, {"count", issue.count}, {"fixed", issue.fixed}, {"severity", severity}};
}

Json bodyJson(const Body& body) {
    const BodyReport& report = body.report;
    Json links = Json::array();
    for (const FleshLink& link : report.links) links.push_back({{"from", json(link.from)}, {"to", json(link.to)}, {"radius", link.radius}, {"volume", link.volume}});
    Json gaps{{"area", report.gaps.area}, {"narrowest", report.gaps.narrowest}, {"widest", report.gaps.widest}, {"places", Json::array()}};
    for (const Vec3& place : report.gaps.places) gaps["places"].push_back(json(place));
    return Json{{"how", nameOf(report.how)},
                {"vertices", body.mesh.vertices.rows()},
                {"triangles", body.mesh.triangles.rows()},
                {"components", report.components},
                {"distance", {{"rms", report.distanceRms}, {"largest", report.distanceLargest}}},
                {"volume_error", report.volumeError < 0.0 ? Json() : Json(report.volumeError)},
                {"detail", report.detail},
                {"links", std::move(links)},
                {"gaps", std::move(gaps)}};
}

Json characterJson(const Document& document, const CharacterSource& character) {
    Json cuts = Json::array(), elements = Json::array();
    for (const PartId id : document.elementsOf(character.id)) elements.push_back(document.elements.at(id)->name);
    for (const Cut& cut : character.cuts) {
        Json between = Json::array({nullptr, nullptr});
        for (const PartId id : document.elementsOf(character.id)) {
            const Element& element = *document.elements.at(id);
            if (const int side = element.piece->sideIndex(cut.id); side >= 0) between[element.piece->sides[static_cast<std::size_t>(side)].front ? 1 : 0] = element.name;
        }
        cuts.push_back({{"name", cut.name}, {"origin", json(cut.plane.origin)}, {"normal", json(cut.plane.normal)}, {"elements", std::move(between)}});
    }
    Json answer{{"name", character.name}, {"parts", partsJson(document, character)}, {"body", bodyJson(*character.body)}, {"cuts", std::move(cuts)}, {"elements", std::move(elements)}};
    answer.update(rigJson(character.rig.get()));
    if (!character.model->morphs.empty()) answer["morphs"] = morphsJson(document, character);
    if (character.rig && !character.rig->avatar.empty()) answer["avatar"] = avatarJson(*character.rig);
    return answer;
}

Json charactersJson(const Document& document) {
    Json characters = Json::array();
    for (const auto& [id, character] : document.characters) characters.push_back(characterJson(document, *character));
    return characters;
}

void addImportCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("import-element",
                       "Imports a mesh (OBJ, PLY, STL, glTF, GLB, VRM, FBX, DAE) as one element or several. Mends what can be mended and tells it.",
                       {{"path", Type::Text, true, "The file."},
                        {"name", Type::Text, false, "A name that no element, bone, handle, character or cut has (from the file unless given; numbered where there are several)."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."},
                        {"split", Type::Boolean, false, "One element per connected component (false)."}},
                       importElement);
    registry.addChange("import-character",
                       "Imports a mesh of any kind (open, of many parts, crossing itself) as a character: what is seen is the file's own mesh, and a closed body moves it. The body is one "
                       "element, which cuts divide.",
                       {{"path", Type::Text, true, "The file."},
                        {"name", Type::Text, false, "A name that no element, bone, handle, character or cut has (from the file unless given)."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."},
                        {"body", Type::Text, false, "\"exact\": the mesh itself, \"mended\": with holes closed and parts united, \"wrapped\": a new surface around it, \"auto\": the first that works (unless given); \"unmended\": wrapped, until the command repair has mended what is wrong with the mesh."},
                        {"detail", Type::Number, false, "Of a wrap, in diagonals of the mesh: gaps narrower than twice this are closed (0.001 to 0.2; chosen from the mesh unless given)."},
                        {"links", Type::Array, false,
                         "Of a mended body: the links of flesh between parts that do not touch, as an import answers with them in \"body\", with links changed, dropped or added: each {\"from\", \"to\" "
                         "(places on two parts), \"radius\"} in metres (those that are found unless given)."}},
                       importCharacterCommand);
}

}  // namespace imomushi
