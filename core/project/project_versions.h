// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/project/project_file.h"
#include "core/project/version_limits.h"

namespace imomushi {

/// What was saved of a project, so that it can be opened again: beside NAME.imomushi in NAME.imomushi-versions, a SQLite file. Meshes, responses and takes are in it once, however
/// many versions have them.
struct ProjectVersion {
    std::int64_t number = 0;  ///< rises; none is given twice
    std::int64_t saved = 0;   ///< when, seconds since 1970
    std::uintmax_t bytes = 0; ///< of its project file
};

[[nodiscard]] std::filesystem::path versionsFile(const std::filesystem::path& project);

/// Keeps the project file that is at `project` now, if it is not one of its versions already. How many there are.
/// Errors: "no-version" with the reason; what was kept before stays.
Result<int> keepVersion(const std::filesystem::path& project, const VersionLimits& limits);

/// Newest first; none where nothing was kept. Errors: "no-version".
Result<std::vector<ProjectVersion>> projectVersions(const std::filesystem::path& project);

/// Trusts nothing that it reads. Errors: "no-version": there is none of that number, or it is damaged.
Result<Project> openVersion(const std::filesystem::path& project, std::int64_t number);

/// The project of a file, or of one of its versions. Errors: those of openProject() or openVersion().
Result<Project> loadProject(const std::filesystem::path& path, std::optional<std::int64_t> version);

/// What saving did.
struct SavedProject {
    std::optional<int> versions;  ///< how many there are now; none: none are kept of this file, or it was new
    std::string notKept;          ///< why this one is not among them, which is no reason not to save
    std::uintmax_t bytes = 0;     ///< of the file
};

/// saveProject(); the file that was there and the new one are kept as versions. Errors: those of saveProject().
Result<SavedProject> storeProject(const std::filesystem::path& path, const Project& project, const VersionLimits& limits);

}  // namespace imomushi
