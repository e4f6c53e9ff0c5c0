// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "core/base/result.h"
#include "core/project/project_file.h"
#include "core/project/sqlite.h"

// What project files and versions of them have in common. All but openToRead() throw DatabaseError.

namespace imomushi {

/// A file that is open to be read.
struct ReadFile {
    explicit ReadFile(const std::filesystem::path& path);
    ~ReadFile();
    ReadFile(ReadFile&& other) noexcept;
    int descriptor;
};

/// Errors: "file-not-found", "not-readable".
Result<ReadFile> openToRead(const std::filesystem::path& path);

/// The project of a database, if it has the format of this program and its content matches its digest.
Project readChecked(Database& db);

/// Copies the tables of a project file that this program knows, unchecked, into an empty database, which gets a digest of its own.
void copyProject(Database& from, Database& to);

}  // namespace imomushi
