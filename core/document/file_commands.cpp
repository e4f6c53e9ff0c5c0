// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/document/command_support.h"
#include "core/document/document_edit.h"
#include "core/document/names.h"
#include "core/document/project_file.h"
#include "core/document/session_access.h"
#include "core/mesh/connectivity.h"

namespace imomushi {

namespace {

constexpr const char* kProjectSuffix = ".imomushi";

const char* stateText(ResponseState state) {
    switch (state) {
        case ResponseState::Fresh: return "fresh";
        case ResponseState::Stale: return "stale";
        case ResponseState::None: return "none";
    }
    return "none";
}

/// What "open" and "list" answer.
Json contents(const Session& session) {
    const Document& document = session.document();
    Json elements = Json::array(), bones = Json::array(), joints = Json::array(), held = Json::array();
    for (const auto& [id, element] : document.elements) {
        Json faces = Json::array();
        for (const JointFace& face : element->faces) faces.push_back(face.name);
        elements.push_back({{"name", element->name},
                            {"vertices", element->mesh->body.vertices.rows()},
                            {"triangles", element->mesh->body.triangles.rows()},
                            {"faces", std::move(faces)},
                            {"state", stateText(session.responseState(id))}});
    }
    for (const auto& [id, bone] : document.bones)
        bones.push_back({{"name", bone->name},
                         {"element", bone->element ? Json(document.elements.at(bone->element)->name) : Json()},
                         {"start", placeJson(document, bone->start)},
                         {"end", placeJson(document, bone->end)},
                         {"parent", bone->parent ? Json(document.bones.at(bone->parent)->name) : Json()}});
    for (const auto& [id, joint] : document.joints) {
        Json faces = Json::array();
        for (const FaceRef& face : joint->faces) faces.push_back(faceText(document, face));
        joints.push_back(std::move(faces));
    }
    for (const auto& [end, target] : document.goals)
        held.push_back({{"endpoint", endpointText(document, end)}, {"pinned", target.pinned}, {"to", json(target.target)}});
    Json answer;
    answer["elements"] = std::move(elements);
    answer["bones"] = std::move(bones);
    answer["joints"] = std::move(joints);
    answer["effects"] = effectsJson(document, false);
    answer["takes"] = Json::array();
    for (const auto& [id, take] : document.takes) answer["takes"].push_back(take->name);
    answer["held"] = std::move(held);
    answer["basis"] = basisName(document.settings.basis);
    return answer;
}

/// Parents as the character sees them: what nobody gave is found from the joint points.
void addFoundParents(Session& session, Json& answer) {
    if (!session.builtCharacter()) return;
    const CharacterPlan& plan = session.plan();
    const auto& bones = session.document().bones;
    auto bone = bones.begin();  // lines are in the order of the document
    for (Json& line : answer["bones"]) {
        const int index = plan.boneIndex((bone++)->first);
        if (index < 0) continue;
        const int parent = plan.input.skeleton.bones[static_cast<std::size_t>(index)].parent;
        line["parent"] = parent < 0 ? Json() : Json(bones.at(plan.bones[static_cast<std::size_t>(parent)])->name);
    }
}

Result<std::filesystem::path> pathOf(const Json& arguments) {
    const std::string& path = text(arguments, "path");
    if (path.empty() || path.find('\0') != std::string::npos) return fail("bad-value", "\"path\" is empty or holds a zero byte.");
    return std::filesystem::path(path);
}

Result<Json> newDocument(SessionAccess& access, const Json& arguments, const Progress&) {
    std::filesystem::path path;
    if (arguments.contains("path")) {
        const auto given = pathOf(arguments);
        if (!given) return tl::unexpected(given.error());
        path = *given;
    }
    access.replace({}, path, true, arguments);
    return Json::object();
}

Result<Json> open(SessionAccess& access, const Json& arguments, const Progress&) {
    const auto path = pathOf(arguments);
    if (!path) return tl::unexpected(path.error());
    auto project = openProject(*path);
    if (!project) return tl::unexpected(project.error());
    const Json* original = find(arguments, "as");
    access.replace(std::move(*project), original ? std::filesystem::path(original->get_ref<const std::string&>()) : *path, !original, arguments);
    Json answer = contents(access.session);
    addFoundParents(access.session, answer);
    return answer;
}

Result<Json> list(SessionAccess& access, const Json&, const Progress&) {
    Json answer = contents(access.session);
    addFoundParents(access.session, answer);
    return answer;
}

Result<Json> save(SessionAccess& access, const Json& arguments, const Progress&) {
    std::filesystem::path path = access.session.path();
    if (arguments.contains("path")) {
        const auto given = pathOf(arguments);
        if (!given) return tl::unexpected(given.error());
        path = *given;
    }
    if (path.empty()) return fail("missing-key", "The project was never saved: give \"save\" a \"path\" that ends in .imomushi.");
    if (path.extension() != kProjectSuffix) return fail("bad-value", "\"path\" must end in .imomushi.");
    if (auto saved = saveProject(path, access.session.project()); !saved) return tl::unexpected(saved.error());
    if (!arguments.value("copy", false)) access.markSaved(path);
    std::error_code error;
    return Json{{"bytes", std::filesystem::file_size(path, error)}};
}

Result<Json> saveScript(SessionAccess& access, const Json& arguments, const Progress&) {
    const auto path = pathOf(arguments);
    if (!path) return tl::unexpected(path.error());
    std::string lines;
    for (const Json& line : access.session.script()) lines += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    if (auto written = writeFileAtomically(*path, lines); !written) return tl::unexpected(written.error());
    return Json{{"commands", access.session.script().size()}};
}

template <class Value>
Result<Value> choice(const Json& arguments, const char* key, std::initializer_list<std::pair<const char*, Value>> values, Value otherwise) {
    const Json* given = find(arguments, key);
    if (!given) return otherwise;
    std::string known;
    for (const auto& [name, value] : values) {
        if (*given == name) return value;
        known += std::string(known.empty() ? "\"" : ", \"") + name + "\"";
    }
    return fail("bad-value", std::string("\"") + key + "\" must be one of " + known + ".");
}

Json issueJson(const MeshIssue& issue) {
    const char* severity = issue.severity == Severity::Info ? "info" : issue.severity == Severity::Warning ? "warning" : "error";
    return Json{{"code", issue.code}, {"text", issue.text}, {"count", issue.count}, {"fixed", issue.fixed}, {"severity", severity}};
}

/// Why a body cannot be an element: its first error, or that it is open.
Error refusal(const ImportedBody& body) {
    for (const MeshIssue& issue : body.issues)
        if (issue.severity == Severity::Error && !issue.fixed) return {issue.code, "\"" + body.name + "\": " + issue.text};
    return {"open", "\"" + body.name + "\" is not a closed surface: close its holes in a modelling program."};
}

Result<Json> importElement(DocumentEdit& edit, const Json& arguments, const Progress& progress) {
    Document& document = edit.document;
    ImportRequest request;
    const auto path = pathOf(arguments);
    if (!path) return tl::unexpected(path.error());
    request.path = *path;
    const auto unit = choice<Unit>(arguments, "unit", {{"mm", Unit::Millimetre}, {"cm", Unit::Centimetre}, {"m", Unit::Metre}}, Unit::AsInFile);
    if (!unit) return tl::unexpected(unit.error());
    request.unit = *unit;
    const auto up = choice<UpAxis>(arguments, "up", {{"y", UpAxis::Y}, {"z", UpAxis::Z}}, UpAxis::AsInFile);
    if (!up) return tl::unexpected(up.error());
    request.up = *up;
    request.split = arguments.value("split", false);
    if (const Json* name = find(arguments, "name"))
        if (auto ok = checkNewName(document, name->get_ref<const std::string&>()); !ok) return tl::unexpected(ok.error());

    auto imported = edit.import(request, progress);
    if (!imported) return tl::unexpected(imported.error());
    const auto usable = std::count_if(imported->bodies.begin(), imported->bodies.end(), [](const ImportedBody& body) { return body.closed; });
    if (imported->bodies.empty()) return fail("empty-mesh", "\"" + path->string() + "\" holds no surface.");
    if (usable == 0) {
        const Error error = refusal(imported->bodies.front());
        return fail(error.code, error.message);
    }

    Json elements = Json::array(), issues = Json::array();
    for (const MeshIssue& issue : imported->issues) issues.push_back(issueJson(issue));
    for (ImportedBody& body : imported->bodies) {
        if (!body.closed) {
            issues.push_back({{"code", "left-out"}, {"text", refusal(body).message + " It was left out."}, {"count", 1}, {"fixed", false}, {"severity", "warning"}});
            continue;
        }
        Element element;
        element.id = document.nextId++;
        const Json* name = find(arguments, "name");
        element.name = freeName(document, name ? name->get_ref<const std::string&>() : body.name);
        element.issues = body.issues;
        element.mesh = std::make_shared<const ElementMesh>(std::move(body.mesh));
        const MeshFacts& facts = element.mesh->connectivity().facts();
        Json line;
        line["name"] = element.name;
        line["vertices"] = element.mesh->body.vertices.rows();
        line["triangles"] = element.mesh->body.triangles.rows();
        line["closed"] = body.closed;
        line["components"] = body.components;
        line["volume"] = facts.volume;
        line["size"] = json(facts.high - facts.low);
        line["low"] = json(facts.low);
        line["high"] = json(facts.high);
        elements.push_back(std::move(line));
        for (const MeshIssue& issue : body.issues) {
            Json told = issueJson(issue);
            told["element"] = element.name;
            issues.push_back(std::move(told));
        }
        document.elements.emplace(element.id, std::make_shared<const Element>(std::move(element)));
    }
    Json answer;
    answer["elements"] = std::move(elements);
    answer["issues"] = std::move(issues);
    answer["format"] = imported->format;
    answer["metres_per_unit"] = imported->metresPerUnit;
    answer["turned_z_up"] = imported->zUpConverted;
    return answer;
}

}  // namespace

void addFileCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("new", "Begins an empty document; the history begins anew.", {{"path", Type::Text, false, "Where a later save without a path goes."}}, newDocument);
    registry.addAction("open", "Opens a project; the history begins anew.",
                       {{"path", Type::Text, true, "A .imomushi file."},
                        {"as", Type::Text, false, "The file that this is an unsaved copy of, empty: of none. For recovery."}}, open);
    registry.addAction("save",
                       "Saves the project in one file, responses included. An old file is replaced whole or not at all.",
                       {{"path", Type::Text, false, "A file that ends in .imomushi (where it was opened or saved last unless given)."},
                        {"copy", Type::Boolean, false, "Leaves the session with its old path and its unsaved changes (false)."}},
                       save);
    registry.addAction("save-script", "Saves the commands of this session, without those that were undone, as a script.", {{"path", Type::Text, true, "The file."}}, saveScript);
    registry.addAction("list", "What is in the document: the answer of open.", {}, list);
    registry.addChange("import-element",
                       "Imports a mesh (OBJ, PLY, STL, glTF, GLB, FBX, DAE) as one element or several. Mends what can be mended and tells it.",
                       {{"path", Type::Text, true, "The file."},
                        {"name", Type::Text, false, "A name that no element or bone has (from the file unless given; numbered where there are several)."},
                        {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                        {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."},
                        {"split", Type::Boolean, false, "One element per connected component (false)."}},
                       importElement);
}

}  // namespace imomushi
