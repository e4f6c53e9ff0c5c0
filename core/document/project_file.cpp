// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/project_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <set>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/document/project_content.h"
#include "core/document/project_rows.h"
#include "core/document/project_tables.h"
#include "core/document/response_rows.h"
#include "core/document/version.h"

namespace imomushi {

namespace {

constexpr const char* kProjectTable = R"(
CREATE TABLE info (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE settings (basis TEXT, format TEXT, threads INTEGER, next_id INTEGER);
)";

/// Has arrays in parts.
constexpr int kDividedVersion = 12;

constexpr const char* kUseTable = R"(
CREATE TABLE element_responses (element INTEGER PRIMARY KEY, response INTEGER);
)";

/// Those that came after version `from`, up to `to`. In this order: the same project gives the same bytes.
void createTables(Database& db, int from, int to) {
    const auto came = [&](int version) { return from < version && version <= to; };
    if (came(5)) {
        db.run(kProjectTable);
        createElementTables(db);
        createSkeletonTables(db);
        createResponseTable(db);
        db.run(kUseTable);
        createTouchTable(db);
        createTakeTables(db);
        createEffectTables(db);
    }
    if (came(6)) {
        createHandleTables(db);
        createCharacterTables(db);
    }
    if (came(7)) createAttachmentTables(db);
    if (came(8)) createRigTables(db);
    if (came(9)) createMorphTables(db);
    if (came(10)) {
        createFilledTable(db);
        createMorphTrackTable(db);
    }
    if (came(11)) createBonePropertyTables(db);
    if (came(13)) createDampingTable(db);
}

/// Each response once, though elements share it.
void writeProjectResponses(Database& db, const Project& project) {
    std::map<ContentKey, int> ids;
    std::vector<StoredResponse> once;
    for (const auto& [element, r] : project.responses)
        if (ids.emplace(r.key, static_cast<int>(once.size()) + 1).second) once.push_back(r);
    writeResponses(db, once);
    RowWriter uses(db, "INSERT INTO element_responses VALUES (?,?)");
    for (const auto& [element, r] : project.responses) uses.row(element, ids.at(r.key));
}

void readProjectResponses(Database& db, Project& project, const ResponseTables& tables, bool keep) {
    auto read = readResponses(db, tables, keep);
    std::set<std::int64_t> warped;  // elements that share a response are the same
    RowReader uses(db, "SELECT * FROM element_responses ORDER BY element");
    while (uses.next()) {
        const PartId element = readId(uses);
        const auto found = read.find(uses.integer());
        require(project.document.elements.contains(element) && found != read.end(), "a response belongs to nothing");
        const ResponseRow& row = found->second;
        const Element& of = *project.document.elements.at(element);
        // A stale response of other joint faces fits no more, and its modes cannot be made again.
        if (row.response->bases.size() != of.faces.size() && !row.response->bases.empty() && row.response->bases[0].kind == BasisKind::Modes) continue;
        if (warped.insert(found->first).second) addWarping(*row.response, of.mesh->body, of.faces);
        project.responses.emplace(element, StoredResponse{row.key, row.shape, row.response});
    }
}

/// keepResponses false: checks them and keeps none of their matrices.
Project readProject(Database& db, std::int64_t version, bool keepResponses) {
    Project project;
    Document& document = project.document;
    RowReader settings(db, "SELECT * FROM settings");
    require(settings.next(), "the settings are missing");
    const auto basis = parseBasis(settings.text());
    require(basis.has_value(), "the basis is unknown");
    document.settings.basis = *basis;
    const auto format = responseFormat(settings.text());
    require(format.has_value(), "the format is unknown");
    document.settings.format = *format;
    document.settings.threads = static_cast<int>(settings.integer(0, 1024));
    document.nextId = readId(settings);
    const ReadMeshes meshes = readMeshes(db);
    readElements(db, document, meshes);
    if (version >= 13) readDamping(db, document);
    readSkeleton(db, document, version >= 11);
    if (version >= 3) readProjectResponses(db, project, {version >= 4, version >= 10}, keepResponses);  // older ones are of older solvers
    if (version >= 4) readEffects(db, document);
    if (version >= 5) readTakes(db, document, version >= 7 ? readTakeTurns(db) : std::map<PartId, int>(), version >= 9 ? readTakeMorphs(db) : std::map<PartId, int>());
    if (version >= 6) {
        readHandles(db, document);
        readCharacters(db, document, meshes);
    }
    if (version >= 7) readAttachments(db, document);
    if (version >= 8) readRigs(db, document, version);
    if (version >= 9) readMorphs(db, document);
    std::set<PartId> ids;
    const auto unique = [&](PartId part) { require(part < document.nextId && ids.insert(part).second, "an id is used twice"); };
    for (const auto& [part, element] : document.elements) unique(part);
    for (const auto& [part, joint] : document.joints) unique(part);
    for (const auto& [part, bone] : document.bones) unique(part);
    for (const auto& [part, take] : document.takes) unique(part);
    for (const auto& [part, character] : document.characters) {
        unique(part);
        for (const Cut& cut : character->cuts) unique(cut.id);
    }
    return project;
}

/// The part of the document that a row is of, as the artist knows it; empty: it has no name.
std::string partAt(const Project& project, const Database::Row& row) {
    const Document& document = project.document;
    const auto id = static_cast<PartId>(row.id);
    const auto called = [](const char* kind, const auto& parts, PartId part) {
        const auto found = parts.find(part);
        return found == parts.end() ? std::string() : std::string(kind) + " \"" + found->second->name + "\"";
    };
    const auto isOneOf = [&](std::initializer_list<const char*> tables) { return std::any_of(tables.begin(), tables.end(), [&](const char* table) { return row.table == table; }); };
    if (isOneOf({"elements", "issues", "faces", "pieces", "piece_sides", "handles", "handle_goals", "element_responses"})) return called("element", document.elements, id);
    if (isOneOf({"bones", "held", "bone_properties", "held_turns"})) return called("bone", document.bones, id);
    if (row.table.starts_with("take")) return called("take", document.takes, id);
    if (row.table.starts_with("character") || row.table.starts_with("rig") || row.table.starts_with("morph") || isOneOf({"attachments", "part_turns"})) return called("character", document.characters, id);
    if (isOneOf({"meshes", "materials", "textures"})) {
        // As writeMeshes() numbers them.
        std::set<const ElementMesh*> known;
        for (const auto& [element, part] : document.elements)
            if (known.insert(part->mesh.get()).second && static_cast<std::int64_t>(known.size()) == row.id) return called("element", document.elements, element);
        for (const auto& [character, part] : document.characters)
            if (known.insert(&part->model->mesh).second && static_cast<std::int64_t>(known.size()) == row.id) return called("character", document.characters, character);
    }
    if (row.table.ends_with("responses")) {
        std::set<ContentKey> known;  // as writeProjectResponses() numbers them
        for (const auto& [element, response] : project.responses)
            if (known.insert(response.key).second && static_cast<std::int64_t>(known.size()) == row.id) return "the response of " + called("element", document.elements, element);
    }
    return {};
}

void beginProject(Database& db, int version) {
    db.run(("PRAGMA application_id=" + std::to_string(kProjectApplicationId)).c_str());
    db.run("BEGIN");
    createTables(db, 0, version);
}

/// Ends what beginProject() began, when all rows are there.
void finishProject(Database& db, int version) {
    if (db.divided() && version < kDividedVersion) {
        createTables(db, version, kDividedVersion);
        version = kDividedVersion;
    }
    db.run(("PRAGMA user_version=" + std::to_string(version)).c_str());
    {
        const std::string digest = db.digest(projectTables(version));
        RowWriter info(db, "INSERT INTO info VALUES (?,?)");
        info.row("program", std::string("imomushi ") + kVersion);
        info.row("digest", digest);
    }
    db.run("COMMIT");
}

void writeProject(Database& db, const Project& project) {
    const Document& document = project.document;
    const int version = projectVersion(project);
    beginProject(db, version);
    {
        RowWriter settings(db, "INSERT INTO settings VALUES (?,?,?,?)");
        settings.row(basisName(document.settings.basis), formatName(document.settings.format), document.settings.threads, document.nextId);
    }
    const MeshIds meshes = writeMeshes(db, document);
    writeElements(db, document, meshes);
    writeSkeleton(db, document);
    writeProjectResponses(db, project);
    writeEffects(db, document);
    writeTakes(db, document);
    if (version >= 6) {
        writeHandles(db, document);
        writeCharacters(db, document, meshes);
    }
    if (version >= 7) writeAttachments(db, document);
    if (version >= 8) writeRigs(db, document);
    if (version >= 9) writeMorphs(db, document);
    if (version >= 10) writeMorphTracks(db, document);
    if (version >= 11) writeBoneProperties(db, document);
    if (version >= 13) writeDamping(db, document);
    finishProject(db, version);
}

}  // namespace

int projectVersion(const Document& document) {
    if (std::any_of(document.elements.begin(), document.elements.end(), [](const auto& part) { return part.second->damping != Element().damping; })) return 13;
    if (std::any_of(document.bones.begin(), document.bones.end(), [](const auto& part) { return hasProperties(*part.second); }) ||
        std::any_of(document.goals.begin(), document.goals.end(), [](const auto& part) { return part.second.turn.has_value(); }))
        return 11;
    const auto anyCharacter = [&](const auto& has) { return std::any_of(document.characters.begin(), document.characters.end(), [&](const auto& part) { return has(*part.second); }); };
    const auto named = [](const RigNode& node) { return !node.name.empty(); };
    const auto weighs = [](const RigClip& clip) { return !clip.morphs.empty(); };
    if (anyCharacter([&](const CharacterSource& c) { return c.rig && std::any_of(c.rig->clips.begin(), c.rig->clips.end(), weighs); })) return 10;
    if (anyCharacter([&](const CharacterSource& c) { return !c.model->morphs.empty() || (c.rig && std::any_of(c.rig->nodes.begin(), c.rig->nodes.end(), named)); }) ||
        std::any_of(document.takes.begin(), document.takes.end(), [](const auto& part) { return part.second->layout.morphs > 0; }))
        return 9;
    if (anyCharacter([](const CharacterSource& c) { return c.rig != nullptr; })) return 8;
    const bool attached = std::any_of(document.characters.begin(), document.characters.end(), [](const auto& part) { return !part.second->attachments.empty(); });
    const bool turned = std::any_of(document.takes.begin(), document.takes.end(), [](const auto& part) { return part.second->layout.turns > 0; });
    if (attached || turned) return 7;
    const bool handles = std::any_of(document.elements.begin(), document.elements.end(), [](const auto& part) { return !part.second->handles.empty(); });
    return handles || !document.characters.empty() ? 6 : 5;
}

int projectVersion(const Project& project) {
    const bool filled = std::any_of(project.responses.begin(), project.responses.end(), [](const auto& part) { return saysFilling(*part.second.response); });
    return std::max(filled ? 10 : 0, projectVersion(project.document));
}

ReadFile::ReadFile(const std::filesystem::path& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
ReadFile::ReadFile(ReadFile&& other) noexcept : descriptor(std::exchange(other.descriptor, -1)) {}
ReadFile::~ReadFile() {
    if (descriptor >= 0) ::close(descriptor);
}

Result<ReadFile> openToRead(const std::filesystem::path& path) {
    const std::string name = "\"" + path.string() + "\"";
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return fail("file-not-found", "There is no file " + name + ": check its path.");
    if (!std::filesystem::is_regular_file(path, error)) return fail("not-readable", name + " is not a file: choose a .imomushi file.");
    ReadFile file(path);
    if (file.descriptor < 0) return fail("not-readable", name + " cannot be read: check its permissions.");
    return file;
}

Project readChecked(Database& db, std::int64_t version) {
    RowReader info(db, "SELECT value FROM info WHERE name='digest'");
    require(info.next() && info.text() == db.digest(projectTables(version)), "its content does not match its digest");
    return readProject(db, version, true);
}

void copyProject(Database& from, Database& to, int version) {
    beginProject(to, version);
    for (const std::string_view table : projectTables(version))
        if (table != "value_parts") to.addRows(from, table.data());  // they come with the arrays that they are of
    finishProject(to, version);
}

Result<void> saveProject(const std::filesystem::path& path, const Project& project) {
    AtomicFile file(path);
    if (file.descriptor() < 0) return file.finish();
    try {
        {
            Database db(file.descriptor(), Database::Access::Write);
            writeProject(db, project);
        }
        // What is saved opens: it is read as openProject() will read it.
        Database db(file.descriptor(), Database::Access::Read);
        try {
            readProject(db, db.number("PRAGMA user_version"), false);
        } catch (const DatabaseError& reason) {
            const std::string part = partAt(project, db.row());
            return fail("not-sound", "The project cannot be saved, for it would not open again (" + (part.empty() ? part : part + ": ") + reason.what() +
                                         "): undo what made it so, or remove that part. Nothing was replaced.");
        }
    } catch (const DatabaseError& error) {
        if (error.diskFull) return failDiskFull(path);
        return fail("not-writable", std::string("The project could not be written (") + error.what() + "): nothing was changed on the disk.");
    }
    return file.finish();
}

Result<Project> openProject(const std::filesystem::path& path) {
    const std::string name = "\"" + path.string() + "\"";
    const auto opened = openToRead(path);
    if (!opened) return tl::unexpected(opened.error());
    const auto notAProject = [&] { return fail("not-a-project", name + " is not an Imomushi project: choose a .imomushi file."); };
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    std::array<char, 100> header{};
    if (::pread(opened->descriptor, header.data(), header.size(), 0) != static_cast<ssize_t>(header.size()) || std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0) return notAProject();
    try {
        Database db(opened->descriptor, Database::Access::Read);
        if (db.number("PRAGMA application_id") != kProjectApplicationId) return notAProject();
        const std::int64_t version = db.number("PRAGMA user_version");
        if (version > kProjectVersion)
            return fail("newer-version", name + " was written by a newer version of Imomushi (format " + std::to_string(version) + ", this program knows " +
                                             std::to_string(kProjectVersion) + "): update the program.");
        require(version >= 1, "its version is unknown");
        return readChecked(db, version);
    } catch (const DatabaseError& reason) {
        return fail("damaged", name + " is damaged (" + reason.what() + "): open an earlier version of it.");
    }
}

}  // namespace imomushi
