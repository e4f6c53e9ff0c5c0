// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/project_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <initializer_list>
#include <set>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/try.h"
#include "core/document/cycle.h"
#include "core/document/input_mapping.h"
#include "core/document/kept_pose.h"
#include "core/document/source_calibration.h"
#include "core/project/project_content.h"
#include "core/project/project_rows.h"
#include "core/project/project_tables.h"
#include "core/project/response_rows.h"

namespace imomushi {

namespace {

constexpr const char* kProjectTables = R"(
CREATE TABLE settings (name TEXT PRIMARY KEY, value TEXT);
CREATE TABLE element_responses (element INTEGER PRIMARY KEY, response INTEGER);
)";

void createTables(Database& db) {
    db.run(kProjectTables);
    createElementTables(db);
    createCharacterTables(db);
    createSkeletonTables(db);
    createHandleTables(db);
    createAttachmentTables(db);
    createRigTables(db);
    createMorphTables(db);
    createEffectTables(db);
    createTakeTables(db);
    createResponseTables(db);
    db.createPartTable();
}

constexpr const char *kBasis = "basis", *kFormat = "format", *kThreads = "threads", *kBodyFollows = "body-follows", *kRate = "rate", *kMappings = "mappings", *kPoses = "poses", *kCycles = "cycles", *kCalibrations = "calibrations", *kNextId = "next-id";

void writeSettings(Database& db, const Document& document) {
    RowWriter settings(db, "INSERT INTO settings VALUES (?,?)");
    settings.row(kBasis, basisName(document.settings.basis));
    settings.row(kFormat, formatName(document.settings.format));
    settings.row(kThreads, std::to_string(document.settings.threads));
    std::array<char, 32> follows{};
    const auto written = std::to_chars(follows.data(), follows.data() + follows.size(), document.settings.bodyFollows);
    settings.row(kBodyFollows, std::string(follows.data(), written.ptr));
    if (document.settings.rate != CharacterSettings().rate) settings.row(kRate, std::to_string(document.settings.rate));
    settings.row(kNextId, std::to_string(document.nextId));
    if (document.mappings) settings.row(kMappings, mappingsJson(*document.mappings).dump());
    if (document.poses) settings.row(kPoses, keptPosesJson(*document.poses).dump());
    if (document.cycles) settings.row(kCycles, cyclesJson(*document.cycles).dump());
    if (const Json calibrations = calibrationsJson(document); !calibrations.empty()) settings.row(kCalibrations, calibrations.dump());
    for (const auto& [name, value] : document.unknown.settings) settings.row(name, value);
}

void readSettings(Database& db, Document& document) {
    std::map<std::string, std::string> all;
    RowReader settings(db, "SELECT * FROM settings ORDER BY name");
    while (settings.next()) {
        std::string name = readUtf8(settings);
        all.emplace(std::move(name), readUtf8(settings));
    }
    const auto take = [&](const char* name) {
        auto found = all.extract(name);
        require(!found.empty(), "a setting is missing");
        return found.mapped();
    };
    const auto number = [&]<class Number>(const char* name, Number low, Number high) {
        const std::string text = take(name);
        Number value{};
        const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
        require(read.ec == std::errc() && read.ptr == text.data() + text.size() && value >= low && value <= high, "a setting is out of range");
        return value;
    };
    const auto basis = parseBasis(take(kBasis));
    require(basis.has_value(), "the basis is unknown");
    document.settings.basis = *basis;
    const auto format = responseFormat(take(kFormat));
    require(format.has_value(), "the format is unknown");
    document.settings.format = *format;
    document.settings.threads = static_cast<int>(number(kThreads, std::int64_t{0}, std::int64_t{1024}));
    document.settings.bodyFollows = number(kBodyFollows, 0.0, CharacterSettings::kMostFollow);
    document.nextId = static_cast<PartId>(number(kNextId, std::int64_t{1}, std::int64_t{kMaxId}));
    if (all.contains(kRate)) {
        // One that a newer program knows is none here.
        const auto rate = static_cast<int>(number(kRate, std::int64_t{1}, std::int64_t{100'000}));
        if (std::ranges::find(CharacterSettings::kRates, rate) != CharacterSettings::kRates.end()) document.settings.rate = rate;
    }
    // Projects in which nothing is mapped have no such row.
    if (const auto found = all.extract(kMappings)) {
        const Json list = Json::parse(found.mapped(), nullptr, false);
        auto mappings = list.is_discarded() ? Result<InputMappings>(fail("bad-json", "")) : mappingsFrom(list);
        require(mappings.has_value(), "a mapping is broken");
        setMappings(document, std::move(*mappings));
    }
    if (const auto found = all.extract(kPoses)) {
        const Json list = Json::parse(found.mapped(), nullptr, false);
        auto poses = list.is_discarded() ? Result<KeptPoses>(fail("bad-json", "")) : keptPosesFrom(list);
        require(poses.has_value(), "a kept pose is broken");
        setKeptPoses(document, std::move(*poses));
    }
    if (const auto found = all.extract(kCycles)) {
        const Json list = Json::parse(found.mapped(), nullptr, false);
        auto cycles = list.is_discarded() ? Result<Cycles>(fail("bad-json", "")) : cyclesFrom(list);
        require(cycles.has_value(), "a cycle is broken");
        setCycles(document, std::move(*cycles));
    }
    if (const auto found = all.extract(kCalibrations)) require(readCalibrations(document, Json::parse(found.mapped(), nullptr, false)).has_value(), "a calibration is broken");
    document.unknown.settings = std::move(all);
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

void readProjectResponses(Database& db, Project& project, bool keep) {
    auto read = readResponses(db, keep);
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

/// keep false: checks responses and takes, and keeps none of their numbers.
Project readProject(Database& db, bool keep) {
    Project project;
    Document& document = project.document;
    readSettings(db, document);
    const ReadMeshes meshes = readMeshes(db);
    readElements(db, document, meshes);
    readSkeleton(db, document);
    readProjectResponses(db, project, keep);
    readEffects(db, document);
    readTakes(db, document, keep);
    readHandles(db, document);
    readCharacters(db, document, meshes);
    readAttachments(db, document);
    readRigs(db, document);
    readMorphs(db, document);
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
    if (isOneOf({"bones", "held"})) return called("bone", document.bones, id);
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

void beginProject(Database& db) {
    db.run(("PRAGMA application_id=" + std::to_string(kProjectApplicationId)).c_str());
    db.run(("PRAGMA user_version=" + std::to_string(kProjectVersion)).c_str());
    db.run("BEGIN");
    createTables(db);
}

/// Ends what beginProject() began, when all rows are there.
void finishProject(Database& db) {
    db.seal();
    db.run("COMMIT");
}

void writeProject(Database& db, const Project& project) {
    const Document& document = project.document;
    beginProject(db);
    writeSettings(db, document);
    const MeshIds meshes = writeMeshes(db, document);
    writeElements(db, document, meshes);
    writeSkeleton(db, document);
    writeProjectResponses(db, project);
    writeEffects(db, document);
    writeTakes(db, document);
    writeHandles(db, document);
    writeCharacters(db, document, meshes);
    writeAttachments(db, document);
    writeRigs(db, document);
    writeMorphs(db, document);
    finishProject(db);
}

}  // namespace

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

Project readChecked(Database& db) {
    Database model;
    createTables(model);
    model.seal();
    std::vector<std::string> others = db.compareSchema(model);
    db.checkSeal();
    Project project = readProject(db, true);
    project.dropped = std::move(others);
    return project;
}

void copyProject(Database& from, Database& to) {
    beginProject(to);
    for (const std::string& table : to.tables())
        if (table != Database::kPartTable) to.addRows(from, table);  // these come with the arrays that they are of
    finishProject(to);
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
            readProject(db, false);
        } catch (const DatabaseError& reason) {
            if (!reason.damaged()) throw;
            const std::string part = partAt(project, db.row());
            return fail("not-sound", "The project cannot be saved, for it would not open again (" + (part.empty() ? part : part + ": ") + reason.what() +
                                         "): undo what made it so, or remove that part. Nothing was replaced.");
        }
    } catch (const DatabaseError& error) {
        if (error.kind == DatabaseError::Kind::DiskFull) return failDiskFull(path);
        return fail("not-writable", std::string("The project could not be written (") + error.what() + "): nothing was changed on the disk.");
    }
    return file.finish();
}

Result<Project> openProject(const std::filesystem::path& path) {
    const std::string name = "\"" + path.string() + "\"";
    IMOMUSHI_TRY(const auto opened, openToRead(path));
    const auto notAProject = [&] { return fail("not-a-project", name + " is not an Imomushi project: choose a .imomushi file."); };
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    std::array<char, 100> header{};
    if (::pread(opened.descriptor, header.data(), header.size(), 0) != static_cast<ssize_t>(header.size()) || std::memcmp(header.data(), kMagic.data(), kMagic.size()) != 0) return notAProject();
    try {
        Database db(opened.descriptor, Database::Access::Read);
        if (db.number("PRAGMA application_id") != kProjectApplicationId) return notAProject();
        const std::int64_t version = db.number("PRAGMA user_version");
        if (version > kProjectVersion)
            return fail("newer-version", name + " was written by a newer version of Imomushi (format " + std::to_string(version) + ", this program knows " +
                                             std::to_string(kProjectVersion) + "): update the program.");
        require(version >= 1, "its version is unknown");
        if (version < kProjectVersion)
            return fail("before-release", name + " was made before the first release of Imomushi (format " + std::to_string(version) + "), which this program does not open: make it again from its meshes or scripts.");
        return readChecked(db);
    } catch (const DatabaseError& reason) {
        if (!reason.damaged()) return fail("not-readable", name + " could not be read (" + reason.what() + "): nothing says that it is damaged; try again.");
        return fail("damaged", name + " is damaged (" + reason.what() + "): open an earlier version of it.");
    }
}

}  // namespace imomushi
