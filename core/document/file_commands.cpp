// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/document/project_file.h"
#include "core/document/session_state.h"
#include "core/io/atomic_file.h"

namespace imomushi {

namespace {

constexpr const char* kSuffix = ".imomushi";

const char* stateText(Session::ResponseState state) {
    switch (state) {
        case Session::ResponseState::Fresh: return "fresh";
        case Session::ResponseState::Stale: return "stale";
        case Session::ResponseState::None: return "none";
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
    for (const auto& [end, target] : document.held)
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
void addFoundParents(Session::State& s, Json& answer) {
    if (!s.live()) return;
    for (Json& line : answer["bones"]) {
        const Bone* bone = s.document.boneNamed(line["name"].get_ref<const std::string&>());
        const int index = s.plan.boneIndex(bone->id);
        if (index < 0) continue;
        const int parent = s.plan.input.skeleton.bones[static_cast<std::size_t>(index)].parent;
        line["parent"] = parent < 0 ? Json() : Json(s.document.bones.at(s.plan.bones[static_cast<std::size_t>(parent)])->name);
    }
}

Result<std::filesystem::path> pathOf(const Json& arguments) {
    const std::string& path = text(arguments, "path");
    if (path.empty() || path.find('\0') != std::string::npos) return fail("bad-value", "\"path\" is empty or holds a zero byte.");
    return std::filesystem::path(path);
}

Result<Json> newDocument(Session& session, const Json& arguments, const Progress&) {
    std::filesystem::path path;
    if (arguments.contains("path")) {
        const auto given = pathOf(arguments);
        if (!given) return tl::unexpected(given.error());
        path = *given;
    }
    session.state().replaceDocument({}, path, arguments);
    return Json::object();
}

Result<Json> open(Session& session, const Json& arguments, const Progress&) {
    const auto path = pathOf(arguments);
    if (!path) return tl::unexpected(path.error());
    auto project = openProject(*path);
    if (!project) return tl::unexpected(project.error());
    Session::State& s = session.state();
    const Json* original = find(arguments, "as");
    s.replaceDocument(std::move(project->document), original ? std::filesystem::path(original->get_ref<const std::string&>()) : *path, arguments);
    if (original) s.savedPosition = -1;
    for (auto& [element, stored] : project->responses) {
        s.responses.insert(stored.key, stored.response);
        s.lastResponses.insert_or_assign(element, Session::State::LastResponse{stored.key, stored.shape});
    }
    Json answer = contents(session);
    addFoundParents(s, answer);
    return answer;
}

Result<Json> list(Session& session, const Json&, const Progress&) {
    Json answer = contents(session);
    addFoundParents(session.state(), answer);
    return answer;
}

Result<Json> save(Session& session, const Json& arguments, const Progress&) {
    Session::State& s = session.state();
    std::filesystem::path path = s.path;
    if (arguments.contains("path")) {
        const auto given = pathOf(arguments);
        if (!given) return tl::unexpected(given.error());
        path = *given;
    }
    if (path.empty()) return fail("missing-key", "The project was never saved: give \"save\" a \"path\" that ends in .imomushi.");
    if (path.extension() != kSuffix) return fail("bad-value", "\"path\" must end in .imomushi.");
    if (auto saved = saveProject(path, session.project()); !saved) return tl::unexpected(saved.error());
    if (!arguments.value("copy", false)) {
        s.path = path;
        s.savedPosition = s.position;
        s.pending.file = true;
    }
    std::error_code error;
    return Json{{"bytes", std::filesystem::file_size(path, error)}};
}

Result<Json> saveScript(Session& session, const Json& arguments, const Progress&) {
    const auto path = pathOf(arguments);
    if (!path) return tl::unexpected(path.error());
    std::string lines;
    for (const Json& line : session.script()) lines += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    if (auto written = writeFileAtomically(*path, lines); !written) return tl::unexpected(written.error());
    return Json{{"commands", session.script().size()}};
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

Result<Json> importElement(Session& session, const Json& arguments, const Progress& progress) {
    Session::State& s = session.state();
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
        if (auto ok = checkNewName(s.document, name->get_ref<const std::string&>()); !ok) return tl::unexpected(ok.error());

    auto imported = s.importer(request, progress);
    if (!imported) return tl::unexpected(imported.error());
    const auto usable = std::count_if(imported->bodies.begin(), imported->bodies.end(), [](const ImportedBody& body) { return body.closed; });
    if (imported->bodies.empty()) return fail("empty-mesh", "\"" + path->string() + "\" holds no surface.");
    if (usable == 0) {
        const Error error = refusal(imported->bodies.front());
        return fail(error.code, error.message);
    }

    Document& document = session.edit();
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
        const MeshFacts facts = meshFacts(body.mesh.body);
        Json line;
        line["name"] = element.name;
        line["vertices"] = body.mesh.body.vertices.rows();
        line["triangles"] = body.mesh.body.triangles.rows();
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
        element.mesh = std::make_shared<const ElementMesh>(std::move(body.mesh));
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
    registry.add({"new", "Begins an empty document; the history begins anew.", {{"path", Type::Text, false, "Where a later save without a path goes."}}, false, newDocument});
    registry.add({"open", "Opens a project; the history begins anew.",
                  {{"path", Type::Text, true, "A .imomushi file."},
                   {"as", Type::Text, false, "The file that this is an unsaved copy of, empty: of none. For recovery."}}, false, open});
    registry.add({"save",
                  "Saves the project in one file, responses included. An old file is replaced whole or not at all.",
                  {{"path", Type::Text, false, "A file that ends in .imomushi (where it was opened or saved last unless given)."},
                   {"copy", Type::Boolean, false, "Leaves the session with its old path and its unsaved changes (false)."}},
                  false, save});
    registry.add({"save-script", "Saves the commands of this session, without those that were undone, as a script.", {{"path", Type::Text, true, "The file."}}, false, saveScript});
    registry.add({"list", "What is in the document: the answer of open.", {}, false, list});
    registry.add({"import-element",
                  "Imports a mesh (OBJ, PLY, STL, glTF, GLB, FBX, DAE) as one element or several. Mends what can be mended and tells it.",
                  {{"path", Type::Text, true, "The file."},
                   {"name", Type::Text, false, "A name that no element or bone has (from the file unless given; numbered where there are several)."},
                   {"unit", Type::Text, false, "\"mm\", \"cm\" or \"m\": the unit of the file (its own unless given; metres where it has none)."},
                   {"up", Type::Text, false, "\"y\" or \"z\": the axis of the file that points up (its own unless given; y where it has none)."},
                   {"split", Type::Boolean, false, "One element per connected component (false)."}},
                  true, importElement});
}

}  // namespace imomushi
