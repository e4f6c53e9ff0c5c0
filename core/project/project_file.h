// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/document/document.h"
#include "core/project/stored_response.h"

namespace imomushi {

/// What a project file holds: the document and the responses that its elements have.
struct Project {
    Document document;
    std::map<PartId, StoredResponse> responses;  ///< by element; elements without one are left out
    std::vector<std::string> dropped;            ///< tables of the file that this program does not know: saving drops them
};

/// "IMOM": SQLite's application id of a .imomushi file.
inline constexpr int kProjectApplicationId = 0x494d4f4d;
/// Version of the tables, the first that was released. What a newer program adds without raising it, this one opens: unknown effects and settings stay
/// (Document::unknown), unknown tables are told (Project::dropped). All tables have rowids; "info" holds their digest.
inline constexpr int kProjectVersion = 17;

/// Writes one self-contained SQLite file: beside its place first, on disk, then renamed, so that there is always a whole file. Nothing of an old
/// file is lost when this fails. What is written is read as openProject() reads it before it takes its place. Errors: "not-writable", "disk-full", "not-sound": it would not open
/// again, with the part and what is wrong with it.
Result<void> saveProject(const std::filesystem::path& path, const Project& project);

/// Reads a project without changing its file; trusts nothing in it.
/// Errors: "file-not-found", "not-readable", "not-a-project", "newer-version", "before-release", "damaged" with what is wrong.
Result<Project> openProject(const std::filesystem::path& path);

}  // namespace imomushi
