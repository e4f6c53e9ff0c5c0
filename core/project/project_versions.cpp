// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/project/project_versions.h"

#include <sys/stat.h>

#include <algorithm>
#include <string>

#include "core/base/hash.h"
#include "core/base/try.h"
#include "core/project/project_content.h"
#include "core/project/project_rows.h"

namespace imomushi {

namespace {

/// "IMOV": SQLite's application id of a file of versions.
constexpr std::int64_t kVersionsId = 0x494d4f56, kVersionsFormat = 2;

/// `rest`: keys of parts which are, one after the other, a project file without its large arrays.
constexpr const char* kVersionTables = R"(
CREATE TABLE versions (id INTEGER PRIMARY KEY AUTOINCREMENT, saved INTEGER, bytes INTEGER, digest TEXT, rest BLOB);
CREATE TABLE parts (id INTEGER PRIMARY KEY, key BLOB UNIQUE, bytes BLOB);
CREATE TABLE uses (version INTEGER, part INTEGER, PRIMARY KEY (version, part)) WITHOUT ROWID;
)";

ContentKey keyOfPart(std::span<const std::byte> part) {
    ContentHasher hasher;
    hasher.bytes(part.data(), part.size());
    return hasher.key();
}

/// The parts of arrays of all versions.
class SharedParts final : public PartStore {
public:
    /// version: which one uses what is kept.
    SharedParts(Database& versions, std::int64_t version) : versions_(versions), version_(version) {}

    ContentKey keep(std::span<const std::byte> part) override {
        const ContentKey key = keyOfPart(part);
        std::int64_t id = idOf(key);
        if (id == 0) {
            RowWriter(versions_, "INSERT INTO parts (key, bytes) VALUES (?,?)").row(std::vector{key.high, key.low}, part);
            id = idOf(key);
        }
        RowWriter(versions_, "INSERT OR IGNORE INTO uses VALUES (?,?)").row(version_, id);
        return key;
    }

    /// Any number of bytes: the keys of their parts.
    std::vector<ContentKey> keepAll(std::span<const std::byte> bytes) {
        std::vector<ContentKey> keys;
        for (std::size_t at = 0; at < bytes.size(); at += kPartBytes) keys.push_back(keep(bytes.subspan(at, std::min(kPartBytes, bytes.size() - at))));
        return keys;
    }
    std::vector<std::byte> findAll(const std::vector<ContentKey>& keys) {
        std::vector<std::byte> bytes;
        const std::int64_t most = versions_.number("PRAGMA page_count") * versions_.number("PRAGMA page_size");
        for (const ContentKey& key : keys) {
            const auto part = find(key);
            require(std::ssize(bytes) + std::ssize(part) <= most, "it is larger than the file that it is in");
            bytes.insert(bytes.end(), part.begin(), part.end());
        }
        return bytes;
    }

    std::vector<std::byte> find(const ContentKey& key) override {
        RowReader rows(versions_, ("SELECT bytes FROM parts WHERE key=x'" + blobOf(key) + "'").c_str());
        require(rows.next(), "a part is missing");
        auto part = rows.array<std::byte>();
        require(keyOfPart(part) == key, "a part does not match its key");
        return part;
    }

private:
    static std::string blobOf(const ContentKey& key) {
        constexpr const char* kDigits = "0123456789abcdef";
        std::string text;
        for (const std::uint64_t half : {key.high, key.low})
            for (int byte = 0; byte < 8; ++byte) {
                const auto value = (half >> (8 * byte)) & 0xff;
                text += {kDigits[value >> 4], kDigits[value & 15]};
            }
        return text;
    }
    std::int64_t idOf(const ContentKey& key) { return versions_.number(("SELECT id FROM parts WHERE key=x'" + blobOf(key) + "'").c_str()); }

    Database& versions_;
    std::int64_t version_;
};

tl::unexpected<Error> failVersion(const std::string& what, const char* why) { return fail("no-version", what + " (" + why + ")."); }

/// A file of versions that is ours; an empty one gets its tables.
void prepareVersions(Database& versions) {
    // The journal of a writer that was killed before it was valid lies there until somebody writes; this change of its mode and back removes it now.
    for (const char* mode : {"TRUNCATE", "DELETE"}) versions.run((std::string("PRAGMA journal_mode=") + mode).c_str());
    if (versions.number("SELECT count(*) FROM sqlite_master") == 0 && versions.number("PRAGMA application_id") == 0) {
        versions.run("PRAGMA auto_vacuum=INCREMENTAL");
        versions.run("BEGIN IMMEDIATE");
        versions.run(("PRAGMA application_id=" + std::to_string(kVersionsId)).c_str());
        versions.run(("PRAGMA user_version=" + std::to_string(kVersionsFormat)).c_str());
        versions.run(kVersionTables);
        versions.run("COMMIT");
    }
    require(versions.number("PRAGMA application_id") == kVersionsId && versions.number("PRAGMA user_version") == kVersionsFormat, "the file of versions is of another program");
    Database model;
    model.run(kVersionTables);
    (void)versions.compareSchema(model);
}

/// Takes the oldest versions away that are over the limits, and what only they have. How many are left.
int evict(Database& versions, const VersionLimits& limits) {
    const std::int64_t page = versions.number("PRAGMA page_size");
    for (;;) {
        const std::int64_t count = versions.number("SELECT count(*) FROM versions");
        const auto used = static_cast<std::uintmax_t>((versions.number("PRAGMA page_count") - versions.number("PRAGMA freelist_count")) * page);
        if (count == 0 || (count <= limits.count && used <= limits.bytes)) return static_cast<int>(count);
        const std::string oldest = std::to_string(versions.number("SELECT min(id) FROM versions"));
        versions.run(("DELETE FROM uses WHERE version=" + oldest).c_str());
        versions.run(("DELETE FROM versions WHERE id=" + oldest).c_str());
        versions.run("DELETE FROM parts WHERE id NOT IN (SELECT part FROM uses)");
    }
}

}  // namespace

std::filesystem::path versionsFile(const std::filesystem::path& project) { return project.string() + "-versions"; }

Result<int> keepVersion(const std::filesystem::path& project, const VersionLimits& limits) {
    IMOMUSHI_TRY(const auto file, openToRead(project));
    struct stat now {};
    if (limits.count < 1 || limits.bytes == 0 || ::fstat(file.descriptor, &now) != 0) return 0;
    std::error_code error;
    const bool isNew = !std::filesystem::exists(versionsFile(project), error);
    try {
        Database saved(file.descriptor, Database::Access::Read);
        require(saved.number("PRAGMA application_id") == kProjectApplicationId, "it is no project");
        require(saved.number("PRAGMA user_version") == kProjectVersion, "it is of an older or newer program");
        RowReader info(saved, "SELECT value FROM info WHERE name='digest'");
        require(info.next(), "it has no digest");
        const std::string digest = info.text();
        Database versions(versionsFile(project), true);
        prepareVersions(versions);
        versions.run("BEGIN IMMEDIATE");
        {
            RowReader last(versions, "SELECT digest FROM versions ORDER BY id DESC LIMIT 1");
            if (last.next() && last.text() == digest) return static_cast<int>(versions.number("SELECT count(*) FROM versions"));
        }
        RowWriter(versions, "INSERT INTO versions (saved, bytes, digest) VALUES (?,?,?)").row(std::int64_t{now.st_mtime}, std::int64_t{now.st_size}, digest);
        const std::int64_t number = versions.number("SELECT max(id) FROM versions");
        SharedParts parts(versions, number);
        Database rest;
        rest.setStore(parts);
        rest.run("PRAGMA page_size=512");  // it is mostly small tables
        copyProject(saved, rest);
        RowWriter(versions, "UPDATE versions SET rest=? WHERE id=?").row(parts.keepAll(rest.file()), number);
        const int left = evict(versions, limits);
        require(left > 0, "it is larger than all versions together may be");
        versions.run("COMMIT");
        versions.run("PRAGMA incremental_vacuum");
        return left;
    } catch (const DatabaseError& reason) {
        if (isNew && std::filesystem::file_size(versionsFile(project), error) == 0) std::filesystem::remove(versionsFile(project), error);
        return failVersion("This version of the project could not be kept", reason.what());
    }
}

Result<std::vector<ProjectVersion>> projectVersions(const std::filesystem::path& project) {
    std::vector<ProjectVersion> found;
    std::error_code error;
    const auto file = versionsFile(project);
    if (!std::filesystem::exists(file, error)) return found;
    try {
        Database versions(file, false);
        prepareVersions(versions);
        RowReader rows(versions, "SELECT id, saved, bytes FROM versions ORDER BY id DESC");
        while (rows.next()) {
            ProjectVersion one;
            one.number = rows.integer(1, kMaxId);
            one.saved = rows.integer(0, kMaxId);
            one.bytes = static_cast<std::uintmax_t>(rows.integer(0, kMaxId));
            found.push_back(one);
        }
        return found;
    } catch (const DatabaseError& reason) {
        return failVersion("The versions of the project cannot be read", reason.what());
    }
}

Result<Project> openVersion(const std::filesystem::path& project, std::int64_t number) {
    std::error_code error;
    const auto file = versionsFile(project);
    if (!std::filesystem::exists(file, error)) return fail("no-version", "No versions of this project were kept.");
    try {
        Database versions(file, false);
        prepareVersions(versions);
        versions.run("BEGIN");  // nobody takes parts away meanwhile
        SharedParts parts(versions, 0);
        std::vector<ContentKey> keys;
        {
            RowReader rows(versions, ("SELECT rest FROM versions WHERE id=" + std::to_string(number)).c_str());
            if (!rows.next()) return fail("no-version", "There is no version " + std::to_string(number) + " of this project: \"versions\" lists those that are kept.");
            keys = rows.array<ContentKey>();
        }
        Database rest(parts.findAll(keys));
        rest.setStore(parts);
        require(rest.number("PRAGMA user_version") == kProjectVersion, "its format is unknown");
        return readChecked(rest);
    } catch (const DatabaseError& reason) {
        const std::string version = "Version " + std::to_string(number) + " of the project ";
        return failVersion(version + (reason.damaged() ? "is damaged" : "could not be read"), reason.what());
    }
}

Result<Project> loadProject(const std::filesystem::path& path, std::optional<std::int64_t> version) { return version ? openVersion(path, *version) : openProject(path); }

Result<SavedProject> storeProject(const std::filesystem::path& path, const Project& project, const VersionLimits& limits) {
    SavedProject done;
    std::error_code error;
    const bool keeps = limits.bytes > 0 && std::filesystem::is_regular_file(path, error);  // a file that is new has no versions
    const auto keep = [&] {
        if (!keeps) return;
        const auto kept = keepVersion(path, limits);
        done.versions = kept ? std::optional(*kept) : std::nullopt;
        done.notKept = kept ? std::string() : kept.error().message;
    };
    keep();  // whoever wrote it
    if (auto saved = saveProject(path, project); !saved) return tl::unexpected(saved.error());
    keep();
    done.bytes = std::filesystem::file_size(path, error);
    return done;
}

}  // namespace imomushi
