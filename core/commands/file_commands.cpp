// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/base/abandoned_files.h"
#include "core/base/atomic_file.h"
#include "core/commands/core_commands.h"
#include "core/commands/effect_commands.h"
#include "core/commands/handle_commands.h"
#include "core/commands/mapping_commands.h"
#include "core/document/command_support.h"
#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "core/document/names.h"
#include "core/project/project_versions.h"
#include "core/session/session_access.h"

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
    for (const auto& [end, target] : document.goals) {
        held.push_back({{"endpoint", endpointText(document, end)}, {"pinned", target.pinned}, {"to", json(target.target)}});
        if (target.rotation) held.back()["orientation"] = true;
    }
    Json handles = Json::array();
    for (const auto& [id, element] : document.elements)
        for (const Handle& handle : element->handles) handles.push_back(handleJson(document, *element, handle));
    for (const auto& [handle, goal] : document.handleGoals)
        if (goal.target.held) held.push_back(heldHandleJson(handle, goal));
    Json answer{{"elements", std::move(elements)}, {"bones", std::move(bones)}, {"handles", std::move(handles)},
                {"joints", std::move(joints)}, {"effects", effectsJson(document, false)}, {"takes", Json::array()}};
    for (const auto& [id, take] : document.takes) answer["takes"].push_back(take->name);
    answer["held"] = std::move(held);
    answer["basis"] = basisName(document.settings.basis);
    answer["characters"] = charactersJson(document);
    for (const KeptPose& pose : keptPoses(document)) answer["poses"].push_back(pose.name);
    if (document.cycles) answer["cycles"] = cyclesJson(*document.cycles);
    if (document.mappings) answer["mappings"] = shownMappings(document);
    if (Json calibrations = shownCalibrations(document); !calibrations.empty()) answer["calibrations"] = std::move(calibrations);
    if (const UnknownRows& unknown = document.unknown; !(unknown.effects.empty() && unknown.properties.empty() && unknown.settings.empty())) {
        Json names = Json::array();
        for (const auto& [name, state] : unknown.effects) names.push_back(name);
        for (const auto& [of, values] : unknown.properties)
            if (!unknown.effects.contains(of.first)) names.push_back(of.first + "/" + of.second);
        for (const auto& [name, value] : unknown.settings) names.push_back(name);
        answer["unknown"] = std::move(names);
    }
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

Result<Json> newDocument(SessionAccess& access, const Json& arguments, const Progress&) {
    std::filesystem::path path;
    if (arguments.contains("path"))
        if (auto ok = assign(path, pathFrom(arguments)); !ok) return tl::unexpected(ok.error());
    access.replace({}, path, true, arguments);
    return Json::object();
}

Result<Json> open(SessionAccess& access, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    const bool version = arguments.contains("version");
    IMOMUSHI_TRY(auto project, access.services.read(path, version ? std::optional(arguments["version"].get<std::int64_t>()) : std::nullopt));
    removeAbandonedPartsOf(path);
    const Json* original = find(arguments, "as");
    const std::vector<std::string> dropped = project.dropped;
    // What saving would drop is not lost by an absent-minded "save".
    const bool copy = version || !dropped.empty();
    access.replace(std::move(project), original ? std::filesystem::path(original->get_ref<const std::string&>()) : copy ? std::filesystem::path() : path, !original && !copy, arguments);
    Json answer = contents(access.session);
    addFoundParents(access.session, answer);
    if (!dropped.empty()) answer["dropped"] = dropped;
    return answer;
}

Result<Json> list(SessionAccess& access, const Json&, const Progress&) {
    Json answer = contents(access.session);
    addFoundParents(access.session, answer);
    return answer;
}

Result<Json> save(SessionAccess& access, const Json& arguments, const Progress&) {
    std::filesystem::path path = access.session.path();
    if (arguments.contains("path"))
        if (auto ok = assign(path, pathFrom(arguments)); !ok) return tl::unexpected(ok.error());
    if (path.empty()) return fail("missing-key", "The project was never saved: give \"save\" a \"path\" that ends in .imomushi.");
    if (path.extension() != kProjectSuffix) return fail("bad-value", "\"path\" must end in .imomushi.");
    IMOMUSHI_TRY(const auto saved, access.write(path));
    if (!arguments.value("copy", false)) access.markSaved(path);
    Json answer{{"bytes", saved.bytes}};
    if (saved.versions) answer["versions"] = *saved.versions;
    if (!saved.notKept.empty()) answer["not-kept"] = saved.notKept;
    return answer;
}

Result<Json> listVersions(SessionAccess& access, const Json& arguments, const Progress&) {
    std::filesystem::path path = access.session.path();
    if (arguments.contains("path"))
        if (auto ok = assign(path, pathFrom(arguments)); !ok) return tl::unexpected(ok.error());
    if (path.empty()) return fail("missing-key", "The project was never saved: give \"versions\" the \"path\" of one that was.");
    IMOMUSHI_TRY(const auto versions, projectVersions(path));
    Json lines = Json::array();
    for (const ProjectVersion& version : versions) lines.push_back({{"version", version.number}, {"saved", version.saved}, {"bytes", version.bytes}});
    return Json{{"versions", std::move(lines)}};
}

Result<Json> saveScript(SessionAccess& access, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    if (!access.session.hasScript()) return fail("script-too-long", "This session has been too long for one script: save the project, and the script begins there.");
    const std::vector<Json> script = access.session.script();
    std::string lines;
    for (const Json& line : script) lines += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    if (auto written = writeFileAtomically(path, lines); !written) return tl::unexpected(written.error());
    return Json{{"commands", script.size()}};
}

}  // namespace

void addFileCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("new", "Begins an empty document; the history begins anew.", {{"path", Type::Text, false, "Where a later save without a path goes."}}, newDocument);
    registry.addAction("open", "Opens a project; the history begins anew. \"unknown\": effects and settings of a newer program, which stay; \"dropped\": tables of one, which saving drops, "
                       "so that it is opened as an unsaved copy.",
                       {{"path", Type::Text, true, "A .imomushi file."},
                        {"as", Type::Text, false, "The file that this is an unsaved copy of, empty: of none. For recovery."},
                        {"version", Type::Integer, false, "Of those that \"versions\" lists, instead of the file as it is now: an unsaved copy."}}, open);
    registry.addAction("save",
                       "Saves the project in one file, responses included. An old file is replaced whole or not at all, and what it held is kept among its versions.",
                       {{"path", Type::Text, false, "A file that ends in .imomushi (where it was opened or saved last unless given)."},
                        {"copy", Type::Boolean, false, "Leaves the session with its old path and its unsaved changes (false)."}},
                       save);
    registry.addAction("versions", "What was saved of a project and can be opened again, newest first: \"saved\" in seconds since 1970, \"bytes\" of the file.",
                       {{"path", Type::Text, false, "A .imomushi file (where it was opened or saved last unless given)."}}, listVersions);
    registry.addAction("save-script", "Saves the commands of this session, without those that were undone, as a script.", {{"path", Type::Text, true, "The file."}}, saveScript);
    registry.addAction("list", "What is in the document: the answer of open.", {}, list);
}

}  // namespace imomushi
